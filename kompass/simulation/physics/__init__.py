"""The body of the embedded robot: its MuJoCo model, drive and obstacles."""
