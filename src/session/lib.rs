//! Files of Tautline: dataset folders, session files, model files.
