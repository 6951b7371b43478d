//! The pose that has the stepper's centre of mass and feet, and moves as a pushed person does.
