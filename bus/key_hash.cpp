// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/key_hash.hpp"

#include <algorithm>
#include <fastrtps/utils/md5.h>

namespace gridspace::bus {

KeyHash key_hash(std::span<std::byte const> key, bool always_fits) {
    KeyHash out{};
    auto const* octets = reinterpret_cast<unsigned char const*>(key.data());
    if (always_fits) {
        std::copy_n(octets, std::min(key.size(), out.size()), out.begin());
        return out;
    }
    MD5 md5;
    md5.init();
    md5.update(octets, static_cast<MD5::size_type>(key.size()));
    md5.finalize();
    std::copy_n(md5.digest, out.size(), out.begin());
    return out;
}

} // namespace gridspace::bus
