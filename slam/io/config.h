#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace orb360 {

/// The options that a configuration file may set. Each has a dotted key, a variable, a meaning and
/// a range. The owner of the variables registers them; their values at that moment are the
/// defaults. The file is YAML and has one section for each part of a key before a dot.
class ConfigSchema {
 public:
  static constexpr int kIntMin = std::numeric_limits<int>::min();
  static constexpr int kIntMax = std::numeric_limits<int>::max();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// Registers `*value`, which must outlive the schema, under `key` ("mapping.min_parallax"). `doc`
  /// is one line with the meaning and the unit; a number must lie in [min, max]. Throws
  /// ContractError for a key registered twice, a key that is a section of another, or a default out
  /// of range.
  void Add(const std::string& key, bool* value, const std::string& doc);
  void Add(const std::string& key, std::string* value, const std::string& doc);
  void Add(const std::string& key, int* value, const std::string& doc, int min = kIntMin,
           int max = kIntMax);
  void Add(const std::string& key, double* value, const std::string& doc, double min = -kInfinity,
           double max = kInfinity);
  /// The same for an enumeration whose values, from 0 on, have `names`.
  template <typename Enum>
  void Add(const std::string& key, Enum* value, const std::string& doc,
           std::span<const char* const> names) {
    Add(Option{key,
               Choice{{names.begin(), names.end()},
                      [value] { return static_cast<size_t>(*value); },
                      [value](size_t index) { *value = static_cast<Enum>(index); }},
               doc});
  }

  /// Sets the variables that `file` names. Throws UserError with file, line and key if the file
  /// cannot be read, is not YAML, has an unknown key (the nearest known one is suggested), or has a
  /// value of the wrong type or out of range. In that case no variable is changed.
  void Load(const std::filesystem::path& file) const;

  /// Returns a YAML file of all options at their present values, each below its documentation, in
  /// the order of registration. Load reads it back to exactly these values.
  std::string Document() const;

 private:
  /// A variable with named values.
  struct Choice {
    std::vector<std::string> names;
    std::function<size_t()> get;  ///< Index of the present value's name.
    std::function<void(size_t)> set;
  };
  using Variable = std::variant<bool*, int*, double*, std::string*, Choice>;
  using Value = std::variant<bool, int, double, std::string, size_t>;
  struct Option {
    std::string key;
    Variable variable;
    std::string doc;
    double min = -kInfinity;
    double max = kInfinity;
  };

  void Add(Option option);
  const Option* Find(const std::string& key) const;
  std::string NearestKey(const std::string& key) const;
  static Value Parse(const Option& option, const std::string& text, const std::string& where);

  std::vector<Option> options_;
};

}  // namespace orb360
