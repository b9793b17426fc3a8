// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "gateways/iec61850/frame.hpp"
#include "gateways/scl/source_places.hpp"

#include <map>
#include <string>

namespace gridspace::scl {

/// xs:boolean.
[[nodiscard]] bool is_true(std::string const& text);

/// Reads what a control block and its address say into the keys of a stream. What is not usable is a finding.
class ControlSettings {
  public:
    ControlSettings(Findings& findings, double nominal_hz) : findings_{findings}, nominal_hz_{nominal_hz} {}

    /// MAC address, APPID, VLAN. `where`: the GSE or SMV of Communication, or nothing. False: it cannot be used.
    bool read_address(Element const& control, Element const* where, config::Node& stream);
    /// MinTime and MaxTime, unless they are nonsense: then the defaults are better than no stream.
    void read_times(Element const& where, config::Node& stream);
    /// Rate, ASDUs and options of sampled values. False: it cannot be used.
    bool read_sampling(Element const& control, std::string const& data_set, config::Node& stream);
    /// An attribute, or what stands in for one that is not given.
    std::string attribute_or(Element const& control, char const* name, char const* fallback);
    void note_of_protection(Element const& control);

  private:
    using Parameters = std::map<std::string, std::string>; ///< P of an Address, by type

    /// The MAC address; of a group address (R-GOOSE, R-SV) it follows from that.
    void set_destination(Element const& address, Element const& control, Parameters& p, iec61850::Mac const& mac,
                         config::Node& stream);
    void set_vlan(Element const& address, Element const& control, Parameters& p, config::Node& stream);
    void assumed(Element const& where, Element const& control, std::string text, std::string remedy = {});
    void left_out(Element const& where, Element const& control, std::string text, std::string remedy = {});
    void note_of_times(Element const& time, double ms);
    void read_options(Element const& control, Element const& options, std::string const& data_set,
                      config::Node& stream);

    Findings& findings_;
    double nominal_hz_;
};

/// "IED1 gcb1" of a control block.
[[nodiscard]] std::string subject_of(Element const& control);

} // namespace gridspace::scl
