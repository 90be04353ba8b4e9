"""Which files are read, and as what language."""

LANGUAGES = {
    **dict.fromkeys(
        (".c", ".h", ".cc", ".cpp", ".cxx", ".c++", ".hh", ".hpp", ".hxx", ".h++"), "c"
    ),
    **dict.fromkeys((".ipp", ".inl", ".tpp", ".ino", ".cu", ".cuh"), "c"),
    **dict.fromkeys((".py", ".pyi"), "python"),
    ".java": "java",
    ".rs": "rust",
    ".go": "go",
    ".m": "matlab",
}
