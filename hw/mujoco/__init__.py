"""The simulated robot: scene, terrains, sensors and motors in MuJoCo, behind the robot interface."""
