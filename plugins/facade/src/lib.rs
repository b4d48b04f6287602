//! Plugin: facade material with in-shader level-of-detail switching.
