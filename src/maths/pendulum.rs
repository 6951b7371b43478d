//! The inverted pendulum in closed form.
