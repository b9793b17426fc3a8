// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/opendss/dss_script.hpp"

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <map>
#include <span>
#include <string_view>

namespace gridspace::opendss {

using Complex = std::complex<double>;

/// The value of a property, read as what the property expects. What cannot be read is an error, and reads as zero.
class Value {
  public:
    Value(Word const& word, Object const& object, std::string_view property, config::Diagnostics& diagnostics)
        : word_{word}, object_{object}, property_{property}, diagnostics_{diagnostics} {}

    [[nodiscard]] std::string const& text() const { return word_.value; }
    [[nodiscard]] config::SourceMark const& where() const { return word_.where; }
    [[nodiscard]] Word const& word() const { return word_; }
    [[nodiscard]] double number() const;
    [[nodiscard]] double positive() const;     ///< > 0
    [[nodiscard]] double not_negative() const; ///< >= 0
    [[nodiscard]] int integer(int least, int most) const;
    [[nodiscard]] bool yes() const;                 ///< yes, true, y, t against no, false, n, f
    [[nodiscard]] bool delta() const;               ///< delta, ll against wye, ln, y
    [[nodiscard]] std::vector<double> list() const; ///< all rows one after the other
    [[nodiscard]] std::vector<Word> words() const;  ///< of a list
    [[nodiscard]] Complex complex() const;          ///< [r x]
    /// A symmetric matrix from its lower triangle or all of it.
    [[nodiscard]] Eigen::MatrixXd matrix(int order) const;
    void wrong(std::string const& what, std::string const& expected) const;

  private:
    Word const& word_;
    Object const& object_;
    std::string_view property_;
    config::Diagnostics& diagnostics_;
};

/// What the properties of an object mean, by name; those without a meaning here are passed over.
using Meaning = std::map<std::string_view, std::function<void(Value const&)>>;

/// Goes through what a script said about an object, in its order. `after_command` is called where a command ended:
/// there OpenDSS evaluates the object.
void replay(Object const& object, Meaning const& meaning, config::Diagnostics& diagnostics,
            std::function<void()> const& after_command = {});

/// Metres of a unit of length (mi, kft, km, m, ft, in, cm, mm); 0 for none.
[[nodiscard]] double metres(Value const& unit);

/// Whether an object takes part: `enabled`, as it was said last.
[[nodiscard]] bool enabled(Object const& object);

} // namespace gridspace::opendss
