// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/sample_block.hpp"

#include <cstddef>
#include <new>

namespace gridspace::sdk {
namespace {

/// In front of the struct: whose block it is.
struct alignas(std::max_align_t) Head {
    SampleBlock* block;
};

} // namespace

SampleBlock* SampleBlock::decode(idl::NativeLayout const& layout, std::span<std::byte const> cdr) {
    // Pointers and lengths are longer in memory than on the wire; more memory comes when this is not enough.
    auto* const block = new SampleBlock{sizeof(Head) + layout.size() + 2 * cdr.size()};
    auto* const head = static_cast<std::byte*>(block->memory_.allocate(sizeof(Head) + layout.size()));
    new (head) Head{block};
    block->sample_ = head + sizeof(Head);
    if (!idl::decode(layout, cdr, block->sample_, block->memory_)) {
        block->release();
        return nullptr;
    }
    return block;
}

SampleBlock* SampleBlock::of(void const* sample) {
    auto const* const octets = static_cast<std::byte const*>(sample);
    return reinterpret_cast<Head const*>(octets - sizeof(Head))->block;
}

void SampleBlock::release() {
    if (references_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
        delete this;
    }
}

} // namespace gridspace::sdk
