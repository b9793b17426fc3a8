// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/elements.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

/// The network as a user writes it: plain data in SI units of the file. Each engine converts what it needs once, when
/// it is built. The meaning of every parameter is in docs/reference/components.md.
namespace gridspace::sim {

struct Network : Elements {
    std::string name;
    double frequency_hz{60};
    double power_kva{100};    ///< base power
    config::SourceMark where; ///< the file
};

/// The element of that name; nullptr when there is none.
template <class T>
[[nodiscard]] T const* find(std::vector<T> const& elements, std::string_view name) {
    for (T const& element : elements) {
        if (element.name.name == name) {
            return &element;
        }
    }
    return nullptr;
}

template <class T>
[[nodiscard]] std::size_t index_of(std::vector<T> const& elements, std::string_view name) {
    T const* found = find(elements, name);
    return found == nullptr ? elements.size() : static_cast<std::size_t>(found - elements.data());
}

/// The positions of elements by their names, for who asks often: index_of reads the list each time. The elements must
/// outlive it.
class NameIndex {
  public:
    template <class T>
    explicit NameIndex(std::vector<T> const& elements) {
        for (std::size_t i = 0; i < elements.size(); ++i) {
            at_.try_emplace(elements[i].name.name, i);
        }
    }
    /// The number of elements when there is none of that name.
    [[nodiscard]] std::size_t operator[](std::string_view name) const {
        auto const it = at_.find(name);
        return it == at_.end() ? at_.size() : it->second;
    }

  private:
    std::unordered_map<std::string_view, std::size_t> at_;
};

/// A network as its elements see it. The network must outlive it.
class NetworkAround : public Surroundings {
  public:
    explicit NetworkAround(Network const& network, double start_hour_of_day = 0)
        : n_{network}, start_hour_of_day_{start_hour_of_day}, buses_{network.buses} {}
    [[nodiscard]] double frequency_hz() const override { return n_.frequency_hz; }
    [[nodiscard]] double base_kva() const override { return n_.power_kva; }
    [[nodiscard]] std::size_t bus(Ref const& bus) const override { return buses_[bus.name]; }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return n_.buses[buses_[bus.name]].voltage_v; }
    [[nodiscard]] Scale scale(Ref const& profile) const override;
    [[nodiscard]] Element const* element(std::string_view section, Ref const& name) const override;

  private:
    Network const& n_;
    double start_hour_of_day_;
    NameIndex buses_;
};

/// The value of a profile at a number of hours after simulated time 0; 1 when the network has none of that name.
[[nodiscard]] double profile_value(Network const& network, Ref const& profile, double hours, double start_hour_of_day);

} // namespace gridspace::sim
