// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "recorder/mcap/mcap_format.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

/// What reading an MCAP file is made of: for the readers in this folder.
namespace gridspace::mcap {

/// Reads little-endian numbers and texts; after a read beyond the end, ok() is false and values are 0.
class Decoder {
  public:
    explicit Decoder(std::span<std::byte const> bytes) : bytes_{bytes} {}
    template <class T>
    T number() {
        std::uint64_t value = 0;
        if (!need(sizeof(T))) {
            return 0;
        }
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            value |= static_cast<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
        }
        at_ += sizeof(T);
        return static_cast<T>(value);
    }
    std::string text() {
        std::span<std::byte const> const raw = take(number<std::uint32_t>());
        return {reinterpret_cast<char const*>(raw.data()), raw.size()};
    }
    std::map<std::string, std::string> texts() {
        Decoder inner{take(number<std::uint32_t>())};
        std::map<std::string, std::string> out;
        while (inner.ok() && inner.left() > 0) {
            std::string key = inner.text();
            out[std::move(key)] = inner.text();
        }
        ok_ = ok_ && inner.ok();
        return out;
    }
    std::span<std::byte const> take(std::uint64_t size) {
        if (!need(size)) {
            return {};
        }
        auto const out = bytes_.subspan(at_, size);
        at_ += size;
        return out;
    }
    [[nodiscard]] std::uint64_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] bool ok() const { return ok_; }

  private:
    bool need(std::uint64_t size) {
        ok_ = ok_ && size <= left();
        return ok_;
    }
    std::span<std::byte const> bytes_;
    std::size_t at_{0};
    bool ok_{true};
};

/// An MCAP file, record by record. It costs what is there, not what a length in it promises.
class RecordFile {
  public:
    /// The file behind its magic number.
    [[nodiscard]] static Result<RecordFile> open(std::filesystem::path const& file);

    /// The next record, or none at the end, or where the file is cut or damaged: `note` says which.
    [[nodiscard]] bool next(Op& op, std::vector<std::byte>& body, std::string& note);
    /// The next record is the one at `offset`.
    void go_to(std::uint64_t offset);
    [[nodiscard]] std::uint64_t at() const { return at_; }
    [[nodiscard]] std::uint64_t octets() const { return octets_; }
    /// The summary's first record; nothing when the file has none: it was cut.
    [[nodiscard]] std::uint64_t summary_start();

  private:
    std::ifstream stream_;
    std::uint64_t octets_{0}, at_{0};
};

[[nodiscard]] Schema read_schema(Decoder& d);
[[nodiscard]] Channel read_channel(Decoder& d);

} // namespace gridspace::mcap
