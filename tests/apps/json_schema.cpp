#include "tests/apps/json_schema.h"

#include <fmt/format.h>

#include <cmath>
#include <regex>

namespace throng {
namespace {

using Json = nlohmann::json;
using Faults = std::vector<std::string>;

class Validator {
 public:
  explicit Validator(const Json& root) : root_(root) {}

  Faults check(const Json& value, const Json& schema, const std::string& at) const {
    Faults faults;
    const auto fault = [&](const std::string& what) { faults.push_back(at + ": " + what); };
    for (const auto& [word, rule] : schema.items()) {
      if (word == "description" || word == "title" || word == "$schema" || word == "$defs")
        continue;
      if (word == "$ref") {
        add(faults, check(value, target(rule.get<std::string>()), at));
      } else if (word == "type") {
        if (!is_of_type(value, rule.get<std::string>())) fault("is no " + rule.get<std::string>());
      } else if (word == "enum") {
        if (std::find(rule.begin(), rule.end(), value) == rule.end()) fault("is none of the enum");
      } else if (word == "anyOf") {
        bool any = false;
        for (const Json& choice : rule) any |= check(value, choice, at).empty();
        if (!any) fault("meets no choice of anyOf");
      } else if (word == "pattern") {
        if (value.is_string() &&
            !std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>())))
          fault("does not match " + rule.get<std::string>());
      } else if (word == "minLength") {
        if (value.is_string() && value.get<std::string>().size() < rule.get<size_t>())
          fault("is too short");
      } else if (!check_number(word, rule, value, fault) &&
                 !check_list(word, rule, value, at, faults) &&
                 !check_map(word, rule, schema, value, at, faults)) {
        fault("the schema has a word that is not known here: " + word);
      }
    }
    return faults;
  }

 private:
  static void add(Faults& faults, const Faults& more) {
    faults.insert(faults.end(), more.begin(), more.end());
  }

  const Json& target(const std::string& reference) const {
    return root_.at(Json::json_pointer(reference.substr(1)));
  }

  static bool is_of_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "integer") return value.is_number_integer();
    return type == "number" && value.is_number();
  }

  template <typename Fault>
  static bool check_number(const std::string& word, const Json& rule, const Json& value,
                           const Fault& fault) {
    if (word != "minimum" && word != "maximum" && word != "exclusiveMinimum") return false;
    if (!value.is_number()) return true;
    const double number = value.get<double>(), limit = rule.get<double>();
    if (word == "minimum" && number < limit) fault("is below " + rule.dump());
    if (word == "maximum" && number > limit) fault("is above " + rule.dump());
    if (word == "exclusiveMinimum" && number <= limit) fault("is not above " + rule.dump());
    return true;
  }

  bool check_list(const std::string& word, const Json& rule, const Json& value,
                  const std::string& at, Faults& faults) const {
    if (word != "items" && word != "minItems" && word != "maxItems") return false;
    if (!value.is_array()) return true;
    if (word == "minItems" && value.size() < rule.get<size_t>()) faults.push_back(at + ": too few");
    if (word == "maxItems" && value.size() > rule.get<size_t>())
      faults.push_back(at + ": too many");
    if (word == "items")
      for (size_t i = 0; i < value.size(); ++i)
        add(faults, check(value[i], rule, at + "/" + std::to_string(i)));
    return true;
  }

  bool check_map(const std::string& word, const Json& rule, const Json& schema, const Json& value,
                 const std::string& at, Faults& faults) const {
    if (word != "properties" && word != "required" && word != "additionalProperties" &&
        word != "minProperties")
      return false;
    if (!value.is_object()) return true;
    if (word == "minProperties" && value.size() < rule.get<size_t>())
      faults.push_back(at + ": has too few keys");
    if (word == "required")
      for (const Json& key : rule)
        if (!value.contains(key.get<std::string>()))
          faults.push_back(at + ": lacks " + key.get<std::string>());
    if (word == "properties")
      for (const auto& [key, inner] : rule.items())
        if (value.contains(key))
          add(faults, check(value.at(key), inner, fmt::format("{}/{}", at, key)));
    if (word == "additionalProperties" && rule == false)
      for (const auto& [key, inner] : value.items())
        if (!schema.at("properties").contains(key))
          faults.push_back(fmt::format("{}: knows no {}", at, key));
    return true;
  }

  const Json& root_;
};

}  // namespace

std::vector<std::string> faults_of(const Json& document, const Json& schema) {
  return Validator(schema).check(document, schema, "");
}

}  // namespace throng
