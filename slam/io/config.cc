#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "nn/base/number_text.h"
#include "slam/io/yaml_file.h"
#include <orb360/nn/base/check.h>
#include <orb360/slam/io/config.h>

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

/// Returns the key that the user most likely meant, or "" if none is near. A key with the same name
/// in another section is near; otherwise up to a third of the name's characters may differ.
std::string NearestKey(const OptionSchema& schema, const std::string& key) {
  std::string nearest;
  size_t least = std::max<size_t>(2, LastPart(key).size() / 3) + 1;
  for (const OptionSchema::Option& option : schema.options()) {
    const size_t distance =
        LastPart(option.key) == LastPart(key) ? 1 : EditDistance(option.key, key);
    if (distance < least) {
      least = distance;
      nearest = option.key;
    }
  }
  return nearest;
}

/// The value of an option as a file states it; that of a Choice is the index of its name.
using Value = std::variant<bool, int, double, std::string, size_t>;

/// Parses the value of `option`, which stands at `where` in the file.
Value Parse(const OptionSchema::Option& option, const std::string& text, const std::string& where) {
  const auto wrong = [&](const std::string& expected) {
    return UserError(where + option.key + " must be " + expected + ", not `" + text + "`");
  };
  const auto require_range = [&](double value) {
    if (value < option.min || value > option.max) throw wrong(RangeText(option));
  };
  if (std::holds_alternative<bool*>(option.variable)) {
    if (const std::optional<bool> value = ParseBool(text)) return *value;
    throw wrong("true or false");
  }
  if (std::holds_alternative<int*>(option.variable)) {
    const std::optional<int> value = ParseNumber<int>(text);
    if (!value) throw wrong("a whole number");
    require_range(*value);
    return *value;
  }
  if (std::holds_alternative<double*>(option.variable)) {
    const std::optional<double> value = ParseNumber<double>(text);
    if (!value || !std::isfinite(*value)) throw wrong("a number");
    require_range(*value);
    return *value;
  }
  if (const auto* choice = std::get_if<OptionSchema::Choice>(&option.variable)) {
    const auto found = std::ranges::find(choice->names, text);
    if (found == choice->names.end()) throw wrong(RangeText(option));
    return static_cast<size_t>(found - choice->names.begin());
  }
  return text;
}

}  // namespace

void LoadConfig(const std::filesystem::path& file, const OptionSchema& schema) {
  std::vector<Entry> entries;
  Flatten(LoadYamlMap(file), "", file, &entries);

  std::map<std::string, int> line_of;
  std::vector<std::pair<OptionSchema::Variable, Value>> assignments;
  for (const Entry& entry : entries) {
    const OptionSchema::Option* option = schema.Find(entry.key);
    if (option == nullptr) {
      const std::string nearest = NearestKey(schema, entry.key);
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
          if constexpr (std::is_same_v<decltype(target), const OptionSchema::Choice&>) {
            target.set(std::get<size_t>(value));
          } else {
            *target = std::get<std::remove_reference_t<decltype(*target)>>(value);
          }
        },
        variable);
  }
}

std::string DocumentConfig(const OptionSchema& schema) {
  std::string text;
  std::vector<std::string> sections;  // Those that are open, outermost first.
  for (const OptionSchema::Option& option : schema.options()) {
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
    const std::string range = RangeText(option);
    text += indent + "# " + option.doc + (range.empty() ? "" : " (" + range + ")") + "\n";
    text += indent + name + ": ";
    text += std::visit(
                [](const auto& value) {
                  if constexpr (std::is_same_v<decltype(value), const OptionSchema::Choice&>) {
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
