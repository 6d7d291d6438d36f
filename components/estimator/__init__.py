"""Base pose, contacts and contact forces from IMU, encoders and torque estimates alone."""
