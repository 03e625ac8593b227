#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace orb360 {

/// The options of a program: each has a dotted key, a variable, a meaning and a range. A struct of
/// options has a function RegisterOptions(OptionSchema*, Struct*) beside it that adds its members;
/// files are read and documented, and structs are checked (ValidateOptions), over what it adds.
class OptionSchema {
 public:
  /// Lower limit of an integer without a lower limit of its own.
  static constexpr int kIntMin = std::numeric_limits<int>::min();
  /// Upper limit of an integer without an upper limit of its own.
  static constexpr int kIntMax = std::numeric_limits<int>::max();
  /// Limit of a number without a limit of its own.
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// A variable with named values, such as one of an enumeration.
  struct Choice {
    std::vector<std::string> names;   ///< Names of the values, in the order of their index.
    std::function<size_t()> get;      ///< Returns the index of the present value's name.
    std::function<void(size_t)> set;  ///< Sets the variable to the value of that index.
  };
  /// What an option sets.
  using Variable = std::variant<bool*, int*, double*, std::string*, Choice>;
  /// A registered option.
  struct Option {
    std::string key;          ///< Dotted key, such as "features.count".
    Variable variable;        ///< What the option sets.
    std::string doc;          ///< One line with the meaning and the unit.
    double min = -kInfinity;  ///< Smallest value of a number.
    double max = kInfinity;   ///< Largest value of a number.
  };

  /// Registers `*value`, which must outlive the schema, under `key` ("triangulation.min_parallax").
  /// `doc` is one line with the meaning and the unit; a number must be finite and in [min, max].
  /// Throws ContractError for a key registered twice, a key that is a section of another, or a
  /// present value out of range, with key, value and range in the message.
  void Add(const std::string& key, bool* value, const std::string& doc);
  /// Registers a text.
  void Add(const std::string& key, std::string* value, const std::string& doc);
  /// Registers an integer in [min, max].
  void Add(const std::string& key, int* value, const std::string& doc, int min = kIntMin,
           int max = kIntMax);
  /// Registers a finite number in [min, max].
  void Add(const std::string& key, double* value, const std::string& doc, double min = -kInfinity,
           double max = kInfinity);
  /// Registers an enumeration whose values, from 0 on, have `names`.
  template <typename Enum>
  void Add(const std::string& key, Enum* value, const std::string& doc,
           std::span<const char* const> names) {
    Add(Option{key,
               Choice{{names.begin(), names.end()},
                      [value] { return static_cast<size_t>(*value); },
                      [value](size_t index) { *value = static_cast<Enum>(index); }},
               doc});
  }

  /// Returns all options in the order of registration.
  std::span<const Option> options() const { return options_; }
  /// Returns the option with this key, or null if there is none.
  const Option* Find(const std::string& key) const;

 private:
  void Add(Option option);

  std::vector<Option> options_;
};

/// Returns the values that an option may have as text: "1 to 64", "at least 100", "red or green".
/// It is empty if every value of the type is allowed.
std::string RangeText(const OptionSchema::Option& option);

/// Checks a struct of options against the ranges that its RegisterOptions states. Throws
/// ContractError with key, value and range of the first option that is out of range.
template <typename Struct>
void ValidateOptions(Struct options) {
  OptionSchema schema;
  RegisterOptions(&schema, &options);
}

}  // namespace orb360
