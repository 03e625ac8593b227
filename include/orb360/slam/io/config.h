#pragma once

#include <filesystem>
#include <string>

#include <orb360/nn/base/option_schema.h>

namespace orb360 {

/// Reads a configuration file: YAML with one section for each part of a key before a dot
/// (docs/formats/configuration.md). Sets the variables in `schema` that `file` names. Throws
/// UserError with file, line and key if the file cannot be read, is not YAML, has an unknown key
/// (the nearest known one is suggested), or has a value of the wrong type or out of range. In that
/// case no variable is changed.
void LoadConfig(const std::filesystem::path& file, const OptionSchema& schema);

/// Returns a configuration file of all options at their present values, each below its
/// documentation, in the order of registration. LoadConfig reads it back to exactly these values.
std::string DocumentConfig(const OptionSchema& schema);

}  // namespace orb360
