//! Controls by name: keys, mouse, gamepad and touch, as the visitor wants them.
