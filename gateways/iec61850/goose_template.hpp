// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/iec61850/data_set.hpp"
#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/mms_data.hpp"

namespace gridspace::iec61850 {

/// The constant part of a GOOSE stream.
struct GooseDescription {
    std::string gocb_ref, dat_set;
    std::string go_id; ///< empty: not sent
    std::uint32_t conf_rev{1};
    DataSet data_set;
    IntegerForm integers{IntegerForm::minimal};
};

/// What differs between two messages of the same data.
struct GooseState {
    std::uint32_t st_num{1}, sq_num{0}, live_ms{0};
    UtcTime t;
    bool simulation{false}; ///< in the PDU and in the S bit of the header: they must agree
    bool nds_com{false};
};

/// A GOOSE frame with everything constant written once. Values and counters are patched in place while their lengths
/// stay; a longer integer or string moves what stands behind it, in the same memory. Allocates nothing after create().
class GooseTemplate {
  public:
    static constexpr std::size_t kMaxReference = 129;

    /// Fails when a name is not allowed, or when the data set with its longest values would not fit in a frame.
    [[nodiscard]] static Result<GooseTemplate> create(Address const& address, GooseDescription const& description);

    [[nodiscard]] std::vector<Leaf> const& leaves() const noexcept { return leaves_; }
    [[nodiscard]] std::optional<std::size_t> index_of(std::string_view leaf) const noexcept;
    [[nodiscard]] Value get(std::size_t leaf) const noexcept;

    /// Stores a value for the next frame. `refused`: another type than the leaf's, a number out of its range, a string
    /// too long. Of a quality the bit "derived", which only sampled values have, is left out.
    enum class Stored : std::uint8_t { refused, same, changed };
    Stored set(std::size_t leaf, Value const& value) noexcept;

    [[nodiscard]] Octets frame(GooseState const& state) noexcept;
    /// Octets of the frame with the longest values.
    [[nodiscard]] std::size_t longest_frame() const noexcept { return buffer_.size(); }

    void set_source(Mac const& source) noexcept;

  private:
    struct Slot {
        std::uint64_t bits{0};
        std::uint32_t text_at{0}; ///< in texts_
        std::uint16_t text_octets{0};
        std::uint8_t bit_count{0};
        std::uint32_t at{0};      ///< of the element in the frame
        std::uint32_t content{0}; ///< octets of its content
        bool dirty{true};
    };
    struct Number {
        std::uint32_t at{0}, octets{0};
    };

    [[nodiscard]] std::size_t unsigned_octets(std::uint32_t value) const noexcept;
    [[nodiscard]] bool patchable(GooseState const& state) const noexcept;
    void write_all(GooseState const& state) noexcept;
    void patch(GooseState const& state) noexcept;
    [[nodiscard]] std::size_t members_octets(std::vector<DataNode> const& members, std::size_t& leaf) const noexcept;
    void write_members(BerWriter& out, std::size_t start, std::vector<DataNode> const& members,
                       std::size_t& leaf) noexcept;
    [[nodiscard]] std::size_t pdu_octets(GooseState const& state, std::size_t data) const noexcept;

    GooseDescription description_;
    std::vector<Leaf> leaves_;
    std::vector<Slot> slots_;
    std::vector<std::uint8_t> texts_, buffer_;
    std::size_t app_id_{0}, size_{0};
    Number live_, st_num_, sq_num_;
    std::uint32_t t_at_{0}, simulation_at_{0}, nds_com_at_{0};
    bool written_{false};
};

} // namespace gridspace::iec61850
