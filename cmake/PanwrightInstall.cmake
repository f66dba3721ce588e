# cmake --install: headers, libraries, tool, schema, presets and a package config.
