//! Plugin: the camera controller that all else drives: walk, fly, examine.
