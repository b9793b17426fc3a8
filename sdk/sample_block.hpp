// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/native_sample.hpp"

#include <atomic>
#include <utility>

namespace gridspace::sdk {

/// A received sample and all that it points to. It is found again by the address of its struct, and counts who needs
/// it.
class SampleBlock {
  public:
    /// With one reference; nullptr when the octets are no sample of the type.
    [[nodiscard]] static SampleBlock* decode(idl::NativeLayout const& layout, std::span<std::byte const> cdr);
    /// Of the struct that sample() gave.
    [[nodiscard]] static SampleBlock* of(void const* sample);

    [[nodiscard]] void const* sample() const { return sample_; }
    void keep() { references_.fetch_add(1, std::memory_order_relaxed); }
    void release();

  private:
    explicit SampleBlock(std::size_t octets) : memory_{octets} {}
    std::atomic<int> references_{1};
    std::pmr::monotonic_buffer_resource memory_;
    void* sample_{nullptr};
};

/// One reference to a block.
class KeptSample {
  public:
    explicit KeptSample(SampleBlock* block) : block_{block} {}
    KeptSample(KeptSample&& other) noexcept : block_{std::exchange(other.block_, nullptr)} {}
    KeptSample& operator=(KeptSample&& other) noexcept {
        std::swap(block_, other.block_);
        return *this;
    }
    KeptSample(KeptSample const&) = delete;
    KeptSample& operator=(KeptSample const&) = delete;
    ~KeptSample() {
        if (block_ != nullptr) {
            block_->release();
        }
    }
    [[nodiscard]] void const* get() const { return block_->sample(); }

  private:
    SampleBlock* block_;
};

} // namespace gridspace::sdk
