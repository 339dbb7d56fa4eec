//! Words -> Args -> Job; the only module that prints.
