// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/xml.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "experiments/files/numbers.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/text_encoding.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

constexpr std::string_view blanks = " \t\r\n";

std::string place_in(std::string_view text, std::size_t at) {
  std::size_t line = 1;
  for (std::size_t i = 0; i < std::min(at, text.size()); ++i)
    line += text[i] == '\n' || (text[i] == '\r' && text.substr(i, 2) != "\r\n");
  return TextScanner::place(line);
}

/// The next word, taken from the text; empty at its end.
std::string_view word_of(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

/// By appending: g++ 12 warns of the sum of a literal and a new text, where it is optimised by -O3.
std::string tag(std::string_view name) { return std::string(1, '<').append(name).append(1, '>'); }

std::string_view local(std::string_view name) { return name.substr(name.find(':') + 1); }

}  // namespace

/// Reads from the beginning to the end, once.
class XmlParser {
 public:
  explicit XmlParser(Xml& xml) : xml_(xml), text_(xml.text_) {}

  void parse() {
    while (at_ < text_.size()) {
      if (text_[at_] == '<')
        markup();
      else
        characters();
    }
    if (!open_.empty())
      fault("truncated: " + tag(open_.back().name) + " of " +
            place_in(text_, xml_.elements_[open_.back().number].at) + " does not end");
    if (xml_.elements_.empty()) fault("no XML");
    xml_.attributes_.shrink_to_fit();
  }

 private:
  struct Open {
    std::string_view name;  // with its prefix
    std::uint32_t number, last_child = Xml::none;
    std::string joined;  // of a text in several pieces
  };

  [[noreturn]] void fault(const std::string& what) const {
    throw Unusable(xml_.name_, place_in(text_, at_) + ": " + what);
  }
  bool begins(std::string_view with) const { return text_.substr(at_).starts_with(with); }
  /// Goes beyond the next such end; returns what is before it.
  std::string_view until(std::string_view end, const char* what) {
    const std::size_t found = text_.find(end, at_);
    if (found == text_.npos) fault(std::string("truncated: ") + what + " does not end");
    const std::string_view before = text_.substr(at_, found - at_);
    at_ = found + end.size();
    return before;
  }
  void pass_blanks() { at_ = std::min(text_.find_first_not_of(blanks, at_), text_.size()); }

  void markup() {
    if (begins("<!--")) {
      until("-->", "a comment");
    } else if (begins("<?")) {
      until("?>", "a processing instruction");
    } else if (begins("<![CDATA[") && !open_.empty()) {
      at_ += 9;
      append(until("]]>", "CDATA"));
    } else if (begins("<!DOCTYPE") && xml_.elements_.empty()) {
      if (until(">", "DOCTYPE").find('[') != text_.npos) fault("declared entities are not read");
    } else if (begins("</")) {
      end_tag();
    } else {
      start_tag();
    }
  }

  void characters() {
    const std::size_t end = std::min(text_.find('<', at_), text_.size());
    const std::string_view raw = text_.substr(at_, end - at_);
    if (!open_.empty())
      append(decoded(raw));
    else if (raw.find_first_not_of(std::string_view(" \t\r\n\0\x1a", 6)) != raw.npos)
      fault("text outside of all elements");
    at_ = end;
  }

  std::string_view taken_name() {
    const std::size_t begin = at_;
    const auto is_letter = [](char c) {
      return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '_' || (c & 0x80) != 0;
    };
    while (at_ < text_.size() &&
           (is_letter(text_[at_]) || (at_ > begin && (('0' <= text_[at_] && text_[at_] <= ':') ||
                                                      text_[at_] == '-' || text_[at_] == '.'))))
      ++at_;
    if (at_ == begin) fault("a name is missing");
    return text_.substr(begin, at_ - begin);
  }

  void start_tag() {
    const std::size_t begin = at_++;
    const std::string_view name = taken_name();
    if (open_.empty() && !xml_.elements_.empty()) fault("a second root");
    const auto number = static_cast<std::uint32_t>(xml_.elements_.size());
    xml_.elements_.push_back(
        {local(name), {}, begin, static_cast<std::uint32_t>(xml_.attributes_.size())});
    if (!open_.empty()) {
      auto& last = open_.back().last_child;
      (last == Xml::none ? xml_.elements_[open_.back().number].first_child
                         : xml_.elements_[last].next) = number;
      last = number;
    }
    for (;;) {
      const std::size_t after = at_;
      pass_blanks();
      if (begins("/>")) return void(at_ += 2);
      if (begins(">")) break;
      if (at_ == text_.size()) fault("truncated: a tag does not end");
      if (at_ == after) fault("blanks are missing");
      attribute(number);
    }
    ++at_;
    open_.push_back({name, number, Xml::none, {}});
  }

  void attribute(std::uint32_t element) {
    const std::string_view name = taken_name();
    pass_blanks();
    if (!begins("=")) fault("attribute " + TextScanner::shown(name) + " without a value");
    ++at_;
    pass_blanks();
    if (!begins("\"") && !begins("'"))
      fault("attribute " + TextScanner::shown(name) + ": its value is not quoted");
    const std::string_view quote = text_.substr(at_++, 1);
    const std::string_view value = until(quote, "the value of an attribute");
    if (value.find('<') != value.npos) fault("'<' in attribute " + TextScanner::shown(name));
    const std::size_t first = xml_.elements_[element].attributes;
    if (xml_.attributes_.size() > first + 1000) fault("more than 1000 attributes");
    for (std::size_t i = first; i < xml_.attributes_.size(); ++i)
      if (xml_.attributes_[i].name == name) fault("a second attribute " + TextScanner::shown(name));
    xml_.attributes_.push_back({name, decoded(value)});
  }

  void end_tag() {
    at_ += 2;
    const std::string_view name = taken_name();
    pass_blanks();
    if (!begins(">")) fault("a tag does not end");
    if (open_.empty() || open_.back().name != name)
      fault("</" + std::string(name) + "> where " +
            (open_.empty() ? "nothing" : tag(open_.back().name)) + " is open");
    ++at_;
    if (std::string& joined = open_.back().joined; !joined.empty())
      xml_.elements_[open_.back().number].text = xml_.decoded_.emplace_back(std::move(joined));
    open_.pop_back();
  }

  void append(std::string_view text) {
    if (text.find_first_not_of(blanks) == text.npos) return;
    std::string_view& all = xml_.elements_[open_.back().number].text;
    std::string& joined = open_.back().joined;
    if (all.empty()) {
      all = text;
    } else {
      if (joined.empty()) joined = all;
      joined += text;
    }
  }

  /// With the five entities that need no declaration, and characters by their number.
  std::string_view decoded(std::string_view raw) {
    std::size_t at = raw.find('&');
    if (at == raw.npos) return raw;
    std::string text(raw.substr(0, at));
    while (at < raw.size()) {
      if (raw[at] != '&') {
        text += raw[at++];
        continue;
      }
      const std::size_t end = raw.find(';', at);
      const std::string_view entity = raw.substr(at + 1, end == raw.npos ? 10 : end - at - 1);
      if (end == raw.npos || !append_entity(text, entity))
        fault("unknown entity " + TextScanner::shown(entity));
      at = end + 1;
    }
    return xml_.decoded_.emplace_back(std::move(text));
  }

  static bool append_entity(std::string& text, std::string_view entity) {
    constexpr std::pair<std::string_view, char> known[] = {
        {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
    for (const auto& [name, character] : known)
      if (name == entity) return text += character, true;
    if (!entity.starts_with('#')) return false;
    const bool hex = entity.starts_with("#x");
    const std::string_view digits = entity.substr(hex ? 2 : 1);
    std::uint32_t code = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, hex ? 16 : 10);
    if (error != std::errc{} || end != digits.data() + digits.size() || code == 0 ||
        code > 0x10ffff)
      return false;
    append_utf8(text, code);
    return true;
  }

  Xml& xml_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Open> open_;
};

Xml::Xml(std::string_view bytes, const std::string& name) : name_(name) {
  text_ = as_utf8(bytes, room_, name);
  XmlParser(*this).parse();
}

XmlElement Xml::root() const { return {*this, 0}; }
XmlElement Xml::operator[](std::size_t number) const {
  return {*this, static_cast<std::uint32_t>(number)};
}

std::optional<std::string_view> XmlElement::attribute(std::string_view name) const {
  const auto& all = xml_->attributes_;
  const std::size_t end =
      number_ + 1 < xml_->elements_.size() ? xml_->elements_[number_ + 1].attributes : all.size();
  std::optional<std::string_view> prefixed;
  for (std::size_t i = element().attributes; i < end; ++i) {
    if (all[i].name == name) return all[i].value;
    if (local(all[i].name) == name) prefixed = all[i].value;
  }
  return prefixed;
}

std::string_view XmlElement::needed(std::string_view name) const {
  const auto value = attribute(name);
  if (!value) fault("has no attribute " + std::string(name));
  return *value;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
  std::optional<XmlElement> found;
  each_child([&](const XmlElement& child) {
    if (!found && child.name() == name) found = child;
  });
  return found;
}

XmlElement XmlElement::needed_child(std::string_view name) const {
  const auto found = child(name);
  if (!found) fault("has no <" + std::string(name) + ">");
  return *found;
}

std::string XmlElement::place() const { return place_in(xml_->text_, element().at); }

void XmlElement::fault(const std::string& what) const {
  throw Unusable(xml_->name_, place() + ": <" + std::string(name()) + ">: " + what);
}

double XmlElement::number_of(std::string_view word) const {
  double value = 0;
  if (!TextScanner::parse(word, value) && std::isfinite(value))
    fault(TextScanner::shown(word) + " is not a number");
  if (!std::isfinite(value)) fault(TextScanner::shown(word) + " is not finite");
  if (TextScanner::vanishes(word, value))
    fault(TextScanner::shown(word) + " is too small for float64");
  return value;
}

std::vector<double> XmlElement::numbers(std::string_view text) const {
  std::vector<double> values;
  for (auto word = word_of(text); !word.empty(); word = word_of(text))
    values.push_back(number_of(word));
  return values;
}

std::vector<double> XmlElement::numbers(std::string_view text, std::size_t count) const {
  auto values = numbers(text);
  if (values.size() != count)
    fault("holds " + std::to_string(values.size()) + " numbers, not " + std::to_string(count));
  return values;
}

std::uint32_t XmlElement::index_of(std::string_view word) const {
  if (const auto value = number_in<std::uint32_t>(word)) return *value;
  fault(TextScanner::shown(word) + " is not an index");
}

std::vector<std::uint32_t> XmlElement::indices() const {
  std::vector<std::uint32_t> values;
  std::string_view left = text();
  for (auto word = word_of(left); !word.empty(); word = word_of(left))
    values.push_back(index_of(word));
  return values;
}

std::uint32_t XmlElement::index(std::string_view name) const {
  std::string_view value = needed(name);
  const std::string_view word = word_of(value);
  if (!word_of(value).empty()) fault(TextScanner::shown(needed(name)) + " is not an index");
  return index_of(word);
}
std::uint32_t XmlElement::index(std::string_view name, std::uint32_t otherwise) const {
  return attribute(name) ? index(name) : otherwise;
}
double XmlElement::number(std::string_view name) const { return numbers(needed(name), 1)[0]; }

}  // namespace bvlab
