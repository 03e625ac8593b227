#include "slam/io/config.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "nn/base/check.h"
#include "slam/io/number_text.h"
#include "slam/io/yaml_file.h"

namespace orb360 {
namespace {

/// A scalar value of the file with its dotted key.
struct Entry {
  std::string key;
  std::string text;
  int line;           ///< From 1.
  std::string where;  ///< "file:line: "
};

/// Appends the scalars below `map`, whose own key is `prefix` ("" at the top).
void Flatten(const YAML::Node& map, const std::string& prefix, const std::filesystem::path& file,
             std::vector<Entry>* entries) {
  for (const auto& item : map) {
    const std::string where = WhereIs(file, item.first);
    if (!item.first.IsScalar()) throw UserError(where + "a key must be a plain word");
    const std::string key =
        prefix.empty() ? item.first.Scalar() : prefix + "." + item.first.Scalar();
    if (item.second.IsMap()) {
      Flatten(item.second, key, file, entries);
    } else if (item.second.IsScalar()) {
      entries->push_back({key, item.second.Scalar(), item.first.Mark().line + 1, where});
    } else if (item.second.IsSequence()) {
      throw UserError(where + key + " must be a single value, not a list");
    }
    // The key has no value: it is a section or an option that keeps its default.
  }
}

/// Levenshtein's distance: single-character insertions, deletions and replacements.
size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i + 1);
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string_view LastPart(std::string_view key) {
  return key.substr(key.rfind('.') + 1);  // npos + 1 is 0.
}

std::optional<bool> ParseBool(std::string_view text) {
  if (text == "true" || text == "yes" || text == "on") return true;
  if (text == "false" || text == "no" || text == "off") return false;
  return std::nullopt;
}

/// The text in YAML's double-quoted style.
std::string Quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

std::string TextOf(bool value) { return value ? "true" : "false"; }
std::string TextOf(const std::string& value) { return Quoted(value); }
template <typename Number>
std::string TextOf(Number value) {
  return ToText(value);
}

/// The range of a number as text, such as " (at least 1)"; empty for a number without limits.
std::string RangeNote(double min, double max, bool is_int) {
  const bool has_min = is_int ? min > ConfigSchema::kIntMin : std::isfinite(min);
  const bool has_max = is_int ? max < ConfigSchema::kIntMax : std::isfinite(max);
  if (has_min && has_max) return ToText(min) + " to " + ToText(max);
  if (has_min) return "at least " + ToText(min);
  if (has_max) return "at most " + ToText(max);
  return {};
}

/// "a or b", "a, b or c".
std::string ListOf(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += names[i];
  }
  return text;
}

}  // namespace

void ConfigSchema::Add(const std::string& key, bool* value, const std::string& doc) {
  Add(Option{key, value, doc});
}

void ConfigSchema::Add(const std::string& key, std::string* value, const std::string& doc) {
  Add(Option{key, value, doc});
}

void ConfigSchema::Add(const std::string& key, int* value, const std::string& doc, int min,
                       int max) {
  ORB360_CHECK(min <= *value && *value <= max, key, *value, min, max);
  Add(Option{key, value, doc, static_cast<double>(min), static_cast<double>(max)});
}

void ConfigSchema::Add(const std::string& key, double* value, const std::string& doc, double min,
                       double max) {
  ORB360_CHECK(std::isfinite(*value) && min <= *value && *value <= max, key, *value, min, max);
  Add(Option{key, value, doc, min, max});
}

void ConfigSchema::Add(Option option) {
  for (const Option& other : options_) {
    ORB360_CHECK(other.key != option.key && !other.key.starts_with(option.key + ".") &&
                     !option.key.starts_with(other.key + "."),
                 option.key, other.key);
  }
  options_.push_back(std::move(option));
}

const ConfigSchema::Option* ConfigSchema::Find(const std::string& key) const {
  const auto found = std::ranges::find(options_, key, &Option::key);
  return found == options_.end() ? nullptr : &*found;
}

/// Returns the key that the user most likely meant, or "" if none is near. A key with the same name
/// in another section is near; otherwise up to a third of the characters may differ.
std::string ConfigSchema::NearestKey(const std::string& key) const {
  std::string nearest;
  size_t least = std::max<size_t>(2, key.size() / 3) + 1;
  for (const Option& option : options_) {
    const size_t distance =
        LastPart(option.key) == LastPart(key) ? 1 : EditDistance(option.key, key);
    if (distance < least) {
      least = distance;
      nearest = option.key;
    }
  }
  return nearest;
}

ConfigSchema::Value ConfigSchema::Parse(const Option& option, const std::string& text,
                                        const std::string& where) {
  const auto wrong = [&](const std::string& expected) {
    return UserError(where + option.key + " must be " + expected + ", not `" + text + "`");
  };
  const auto require_range = [&](double value, bool is_int) {
    if (value < option.min || value > option.max) {
      throw wrong(RangeNote(option.min, option.max, is_int));
    }
  };
  if (std::holds_alternative<bool*>(option.variable)) {
    if (const std::optional<bool> value = ParseBool(text)) return *value;
    throw wrong("true or false");
  }
  if (std::holds_alternative<int*>(option.variable)) {
    const std::optional<int> value = ParseNumber<int>(text);
    if (!value) throw wrong("a whole number");
    require_range(*value, true);
    return *value;
  }
  if (std::holds_alternative<double*>(option.variable)) {
    const std::optional<double> value = ParseNumber<double>(text);
    if (!value || !std::isfinite(*value)) throw wrong("a number");
    require_range(*value, false);
    return *value;
  }
  if (const auto* choice = std::get_if<Choice>(&option.variable)) {
    const auto found = std::ranges::find(choice->names, text);
    if (found == choice->names.end()) throw wrong(ListOf(choice->names));
    return static_cast<size_t>(found - choice->names.begin());
  }
  return text;
}

void ConfigSchema::Load(const std::filesystem::path& file) const {
  std::vector<Entry> entries;
  Flatten(LoadYamlMap(file), "", file, &entries);

  std::map<std::string, int> line_of;
  std::vector<std::pair<Variable, Value>> assignments;
  for (const Entry& entry : entries) {
    const Option* option = Find(entry.key);
    if (option == nullptr) {
      const std::string nearest = NearestKey(entry.key);
      throw UserError(entry.where + "unknown key " + entry.key +
                      (nearest.empty() ? "; `orb360 config` lists all keys"
                                       : "; did you mean " + nearest + "?"));
    }
    const auto [first, is_new] = line_of.try_emplace(entry.key, entry.line);
    if (!is_new) {
      throw UserError(entry.where + entry.key + " is set a second time, first in line " +
                      std::to_string(first->second));
    }
    assignments.emplace_back(option->variable, Parse(*option, entry.text, entry.where));
  }
  for (const auto& [variable, value] : assignments) {
    std::visit(
        [&value = value](const auto& target) {
          if constexpr (std::is_same_v<decltype(target), const Choice&>) {
            target.set(std::get<size_t>(value));
          } else {
            *target = std::get<std::remove_reference_t<decltype(*target)>>(value);
          }
        },
        variable);
  }
}

std::string ConfigSchema::Document() const {
  std::string text;
  std::vector<std::string> sections;  // Those that are open, outermost first.
  for (const Option& option : options_) {
    std::vector<std::string> parts;
    for (size_t begin = 0; begin <= option.key.size();) {
      const size_t end = std::min(option.key.find('.', begin), option.key.size());
      parts.push_back(option.key.substr(begin, end - begin));
      begin = end + 1;
    }
    const std::string name = parts.back();
    parts.pop_back();
    const auto common = std::ranges::mismatch(sections, parts).in2 - parts.begin();
    for (size_t depth = static_cast<size_t>(common); depth < parts.size(); ++depth) {
      if (!text.empty()) text += '\n';
      text += std::string(2 * depth, ' ') + parts[depth] + ":\n";
    }
    sections = parts;

    const std::string indent(2 * parts.size(), ' ');
    const auto* choice = std::get_if<Choice>(&option.variable);
    const std::string range =
        choice != nullptr
            ? ListOf(choice->names)
            : RangeNote(option.min, option.max, std::holds_alternative<int*>(option.variable));
    text += indent + "# " + option.doc + (range.empty() ? "" : " (" + range + ")") + "\n";
    text += indent + name + ": ";
    text += std::visit(
                [](const auto& value) {
                  if constexpr (std::is_same_v<decltype(value), const Choice&>) {
                    return value.names[value.get()];
                  } else {
                    return TextOf(*value);
                  }
                },
                option.variable) +
            "\n";
  }
  return text;
}

}  // namespace orb360
