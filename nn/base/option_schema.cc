#include <algorithm>
#include <cmath>
#include <utility>

#include "nn/base/number_text.h"
#include <orb360/nn/base/check.h>
#include <orb360/nn/base/option_schema.h>

namespace orb360 {
namespace {

/// "a or b", "a, b or c".
std::string ListOf(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += names[i];
  }
  return text;
}

template <typename Number>
void CheckRange(const OptionSchema::Option& option, Number value) {
  const double number = static_cast<double>(value);
  if (std::isfinite(number) && option.min <= number && number <= option.max) return;
  const std::string range = RangeText(option);
  throw ContractError(option.key + " must be " + (range.empty() ? "a finite number" : range) +
                      ", not " + ToText(value));
}

}  // namespace

void OptionSchema::Add(const std::string& key, bool* value, const std::string& doc) {
  Add(Option{key, value, doc});
}

void OptionSchema::Add(const std::string& key, std::string* value, const std::string& doc) {
  Add(Option{key, value, doc});
}

void OptionSchema::Add(const std::string& key, int* value, const std::string& doc, int min,
                       int max) {
  Add(Option{key, value, doc, static_cast<double>(min), static_cast<double>(max)});
}

void OptionSchema::Add(const std::string& key, double* value, const std::string& doc, double min,
                       double max) {
  Add(Option{key, value, doc, min, max});
}

void OptionSchema::Add(Option option) {
  for (const Option& other : options_) {
    ORB360_CHECK(other.key != option.key && !other.key.starts_with(option.key + ".") &&
                     !option.key.starts_with(other.key + "."),
                 option.key, other.key);
  }
  if (int* const* number = std::get_if<int*>(&option.variable)) CheckRange(option, **number);
  if (double* const* number = std::get_if<double*>(&option.variable)) CheckRange(option, **number);
  if (const Choice* choice = std::get_if<Choice>(&option.variable)) {
    const size_t index = choice->get();
    if (index >= choice->names.size()) {
      throw ContractError(option.key + " must be " + RangeText(option) + ", not value " +
                          ToText(index));
    }
  }
  options_.push_back(std::move(option));
}

const OptionSchema::Option* OptionSchema::Find(const std::string& key) const {
  const auto found = std::ranges::find(options_, key, &Option::key);
  return found == options_.end() ? nullptr : &*found;
}

std::string RangeText(const OptionSchema::Option& option) {
  if (const auto* choice = std::get_if<OptionSchema::Choice>(&option.variable)) {
    return ListOf(choice->names);
  }
  const bool is_int = std::holds_alternative<int*>(option.variable);
  const bool has_min = is_int ? option.min > OptionSchema::kIntMin : std::isfinite(option.min);
  const bool has_max = is_int ? option.max < OptionSchema::kIntMax : std::isfinite(option.max);
  const auto text = [is_int](double number) {  // to_chars would write 1000000.0 as "1e+06"
    return is_int ? ToText(static_cast<int>(number)) : ToText(number);
  };
  if (has_min && has_max) return text(option.min) + " to " + text(option.max);
  if (has_min) return "at least " + text(option.min);
  if (has_max) return "at most " + text(option.max);
  return {};
}

}  // namespace orb360
