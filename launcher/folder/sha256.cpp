// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/folder/sha256.hpp"

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <openssl/evp.h>

namespace gridspace::launcher {
namespace {

class Digest {
  public:
    Digest() { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
    void add(std::string_view octets) { EVP_DigestUpdate(context_.get(), octets.data(), octets.size()); }
    std::string hex() {
        std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
        unsigned size = 0;
        EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
        std::string out;
        for (unsigned i = 0; i < size; ++i) {
            out += fmt::format("{:02x}", digest[i]);
        }
        return out;
    }

  private:
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

} // namespace

std::string sha256_of(std::filesystem::path const& file) {
    std::ifstream stream{file, std::ios::binary};
    if (!stream) {
        return "";
    }
    Digest digest;
    std::array<char, 65536> buffer{};
    while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0) {
        digest.add({buffer.data(), static_cast<std::size_t>(stream.gcount())});
    }
    return digest.hex();
}

std::string sha256_of_text(std::string_view text) {
    Digest digest;
    digest.add(text);
    return digest.hex();
}

} // namespace gridspace::launcher
