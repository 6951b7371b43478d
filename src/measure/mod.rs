//! What is true of a motion: slip, penetration, ZMP, residual wrench, pops. One definition for bake, audit and tests.
