"""The language of a source file, by its suffix."""

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
