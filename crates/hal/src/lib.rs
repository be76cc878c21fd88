//! Chips of the rig.
