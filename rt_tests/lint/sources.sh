# Prints the tracked and new C and C++ files that match the patterns given, one a line.
sources() { git ls-files --cached --others --exclude-standard -- "$@" | while read -r f; do [ -f "$f" ] && echo "$f"; done; }
