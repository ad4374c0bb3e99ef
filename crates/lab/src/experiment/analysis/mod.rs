//! What records say, as tables and plots.
