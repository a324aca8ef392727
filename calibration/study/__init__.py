"""Speed against error: every way to model a scene, measured."""
