"""The 3D scene, drawn separately for every page that looks."""
