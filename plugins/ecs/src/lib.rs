//! What the plugins share: components, messages, system sets and coordinates.
