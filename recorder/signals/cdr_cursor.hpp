// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace gridspace {

/// Reads the members of a sample in the order of its IDL; little-endian XCDR1 as all our writers send. After something
/// that does not fit it gives zeros, and ok() is false.
class CdrCursor {
  public:
    explicit CdrCursor(std::span<std::byte const> cdr) : data_{cdr.subspan(std::min<std::size_t>(4, cdr.size()))} {
        ok_ = cdr.size() >= 4 && cdr[1] == std::byte{1};
    }
    template <class T>
    T number() {
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        T value{};
        if (!ok_ || at_ + sizeof(T) > data_.size()) {
            ok_ = false;
            return value;
        }
        std::memcpy(&value, data_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    std::string text() {
        auto const size = number<std::uint32_t>();
        if (!ok_ || size == 0 || at_ + size > data_.size()) {
            ok_ = false;
            return {};
        }
        std::string out{reinterpret_cast<char const*>(data_.data() + at_), size - 1};
        at_ += size;
        return out;
    }
    template <class T>
    std::span<std::byte const> numbers(std::uint32_t& count) {
        count = number<std::uint32_t>();
        if (count == 0) {
            return {};
        }
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        if (!ok_ || at_ + static_cast<std::size_t>(count) * sizeof(T) > data_.size()) {
            ok_ = false;
            count = 0;
            return {};
        }
        auto const out = data_.subspan(at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return out;
    }
    [[nodiscard]] bool ok() const { return ok_; }

  private:
    std::span<std::byte const> data_;
    std::size_t at_{0};
    bool ok_;
};

template <class T>
T element(std::span<std::byte const> raw, std::size_t index) {
    T value;
    std::memcpy(&value, raw.data() + index * sizeof(T), sizeof(T));
    return value;
}

} // namespace gridspace
