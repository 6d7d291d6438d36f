"""The robot as rigid bodies: Pinocchio's model and the closed-form leg. Any component may use it."""

from surefoot.components.robot_model.leg_kinematics import LegKinematics
from surefoot.components.robot_model.pinocchio_model import build_model, foot_frame_ids

__all__ = ["LegKinematics", "build_model", "foot_frame_ids"]
