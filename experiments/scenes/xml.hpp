// SPDX-License-Identifier: BSD-3-Clause
/// XML as files of meshes have it: elements, their attributes and text. Names are taken without
/// prefixes; declared entities and validation are left out. What is not well-formed is refused.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bvlab {

class XmlElement;

/// A document in memory, as long as its bytes and name live.
class Xml {
 public:
  /// Throws Unusable, with the line of what is wrong.
  Xml(std::string_view bytes, const std::string& name);
  Xml(const Xml&) = delete;

  XmlElement root() const;
  /// How many elements there are, in the order in which they begin.
  std::size_t size() const { return elements_.size(); }
  XmlElement operator[](std::size_t number) const;

 private:
  friend class XmlElement;
  friend class XmlParser;

  struct Attribute {
    std::string_view name, value;
  };
  static constexpr std::uint32_t none = 0xffffffff;
  struct Element {
    std::string_view name, text;  // without what is in its children
    std::size_t at;
    std::uint32_t attributes, first_child = none, next = none;
  };

  std::string_view text_;
  const std::string& name_;
  std::string room_;                 // of the text as UTF-8
  std::deque<std::string> decoded_;  // what is not in the text as it stands
  std::vector<Element> elements_;
  std::vector<Attribute> attributes_;  // of an element: up to those of the next
};

/// One of its elements; as cheap as a number.
class XmlElement {
 public:
  XmlElement(const Xml& xml, std::uint32_t number) : xml_(&xml), number_(number) {}

  std::uint32_t number() const { return number_; }
  std::string_view name() const { return element().name; }
  std::string_view text() const { return element().text; }
  std::optional<std::string_view> attribute(std::string_view name) const;
  /// The same, without which the file is refused.
  std::string_view needed(std::string_view name) const;
  /// The first child of that name.
  std::optional<XmlElement> child(std::string_view name) const;
  XmlElement needed_child(std::string_view name) const;
  /// Calls with every child, in order.
  template <class Visit>
  void each_child(const Visit& visit) const {
    for (auto child = element().first_child; child != Xml::none;
         child = xml_->elements_[child].next)
      visit(XmlElement(*xml_, child));
  }

  std::string place() const;
  /// Throws Unusable: "FILE: line 7: <name>: what".
  [[noreturn]] void fault(const std::string& what) const;

  /// The numbers in a text: all of them finite.
  std::vector<double> numbers(std::string_view text) const;
  std::vector<double> numbers() const { return numbers(text()); }
  /// So many of them.
  std::vector<double> numbers(std::string_view text, std::size_t count) const;
  /// Whole numbers from 0 on, below 2^32.
  std::vector<std::uint32_t> indices() const;
  std::uint32_t index(std::string_view attribute) const;
  std::uint32_t index(std::string_view attribute, std::uint32_t otherwise) const;
  double number(std::string_view attribute) const;

 private:
  const Xml::Element& element() const { return xml_->elements_[number_]; }
  std::uint32_t index_of(std::string_view word) const;
  double number_of(std::string_view word) const;

  const Xml* xml_;
  std::uint32_t number_;
};

}  // namespace bvlab
