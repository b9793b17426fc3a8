// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive.hpp"

#include "fmi/model_description.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <minizip/zip.h>

namespace gridspace::fmi {
namespace {

using ::testing::HasSubstr;

struct File {
    std::string name;
    std::string content{"x"};
    unsigned mode{0}; ///< st_mode of Unix; 0: not said
};

/// Zip files as nobody should make them.
class AnArchive : public ::testing::Test {
  protected:
    std::filesystem::path zip(std::vector<File> const& files) {
        std::filesystem::path const out = folder_.path() / "sut.fmu";
        zipFile const made = zipOpen64(out.c_str(), APPEND_STATUS_CREATE);
        for (File const& file : files) {
            zip_fileinfo info{};
            info.external_fa = static_cast<uLong>(file.mode) << 16U;
            EXPECT_EQ(zipOpenNewFileInZip4_64(made, file.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                              Z_DEFLATED, 9, 0, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY, nullptr, 0, 3 << 8,
                                              0, 0),
                      ZIP_OK);
            EXPECT_EQ(zipWriteInFileInZip(made, file.content.data(), static_cast<unsigned>(file.content.size())),
                      ZIP_OK);
            EXPECT_EQ(zipCloseFileInZip(made), ZIP_OK);
        }
        EXPECT_EQ(zipClose(made, nullptr), ZIP_OK);
        return out;
    }
    std::string refusal(std::vector<File> const& files) {
        auto const opened = Archive::open(zip(files));
        if (opened) {
            return "it was taken";
        }
        EXPECT_EQ(opened.error().code, ExitCode::usage);
        EXPECT_THAT(opened.error().message, HasSubstr("sut.fmu: "));
        EXPECT_NE(opened.error().remedy, "");
        return opened.error().message;
    }
    TemporaryFolder folder_;
};

TEST_F(AnArchive, GivesItsFilesAndIsUnpackedWithItsFolders) {
    auto const sut = Archive::open(
        zip({{"modelDescription.xml", "<a/>", 0100644}, {"resources/a/b.txt", std::string(100'000, 'z')}}));
    ASSERT_TRUE(sut) << sut.error().message;

    EXPECT_EQ(sut->read("modelDescription.xml").value_or(""), "<a/>");
    ASSERT_TRUE(sut->unpack(folder_.path() / "out"));
    EXPECT_EQ(std::filesystem::file_size(folder_.path() / "out/resources/a/b.txt"), 100'000U);
}

TEST_F(AnArchive, ThatWouldWriteOutsideOfItsFolderIsRefused) {
    EXPECT_THAT(refusal({{"../../evil"}}), HasSubstr("leaves the folder"));
    EXPECT_THAT(refusal({{"resources/../../evil"}}), HasSubstr("leaves the folder"));
    EXPECT_THAT(refusal({{"/etc/passwd"}}), HasSubstr("absolute path"));
    EXPECT_THAT(refusal({{"C:evil"}}), HasSubstr("absolute path"));
    EXPECT_THAT(refusal({{"resources\\..\\evil"}}), HasSubstr("backslash"));
    EXPECT_THAT(refusal({{"a//b"}}), HasSubstr("leaves the folder"));
    EXPECT_THAT(refusal({{"a\x1b[2Jb"}}), HasSubstr("control characters"));
}

TEST_F(AnArchive, WithALinkOrADeviceIsRefused) {
    EXPECT_THAT(refusal({{"resources", "/etc", 0120777}}), HasSubstr("link or a device"));
    EXPECT_THAT(refusal({{"resources/pipe", "", 0010644}}), HasSubstr("link or a device"));
    EXPECT_EQ(refusal({{"resources/file", "", 0100644}}), "it was taken");
}

TEST_F(AnArchive, WithTwoFilesOfOneNameIsRefused) {
    EXPECT_THAT(refusal({{"a"}, {"a"}}), HasSubstr("two files 'a'"));
}

TEST_F(AnArchive, WithANameThatIsTooLongIsRefused) {
    EXPECT_THAT(refusal({{std::string(600, 'a')}}), HasSubstr("too long"));
}

TEST_F(AnArchive, ThatUnpacksToMoreThanThereIsRoomForIsRefusedBeforeItIsUnpacked) {
    auto const file = zip({{"a", "x"}});
    std::ifstream in{file, std::ios::binary};
    std::string text{std::istreambuf_iterator<char>{in}, {}};
    std::size_t const entry =
        text.find(std::string_view{"PK\x01\x02", 4}); // of the table of contents; its size stands 24 octets behind
    ASSERT_NE(entry, std::string::npos);
    text.replace(entry + 24, 4, "\x01\x00\x00\x40", 4);

    auto const sut = Archive::open(std::as_bytes(std::span{text}), "sut.fmu");

    ASSERT_FALSE(sut);
    EXPECT_THAT(sut.error().message, HasSubstr("unpacks to more than 1024 MB"));
}

TEST_F(AnArchive, WhoseFileIsLongerThanItSaysIsNotReadFurther) {
    auto const file = zip({{"a", std::string(1000, 'a')}});
    auto const sut = Archive::open(file);
    ASSERT_TRUE(sut);

    auto const read = sut->read("a", 999);

    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("more than 999 octets"));
}

TEST_F(AnArchive, WithADamagedFileSaysWhich) {
    auto const file = zip({{"modelDescription.xml", std::string(3000, 'a') + "b"}});
    std::ifstream in{file, std::ios::binary};
    std::string text{std::istreambuf_iterator<char>{in}, {}};
    text[60] = static_cast<char>(text[60] ^ 0x55); // of the compressed content
    auto const sut = Archive::open(std::as_bytes(std::span{text}), "sut.fmu");
    ASSERT_TRUE(sut) << sut.error().message;

    auto const read = sut->read("modelDescription.xml");

    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("'modelDescription.xml' is damaged"));
}

TEST_F(AnArchive, ThatIsNoZipFileIsRefused) {
    std::ofstream{folder_.path() / "sut.fmu"} << "MZ this is a program";
    auto const opened = Archive::open(folder_.path() / "sut.fmu");
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, HasSubstr("no zip file"));

    auto const missing = Archive::open(folder_.path() / "none.fmu");
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().remedy, HasSubstr("no such file"));
    auto const folder = Archive::open(folder_.path());
    ASSERT_FALSE(folder);
    EXPECT_THAT(folder.error().remedy, HasSubstr("it is a folder"));
}

TEST_F(AnArchive, CutShortAnywhereIsRefusedOrReadsTheSame) {
    auto const file = zip({{"modelDescription.xml", "<a/>"}, {"binaries/x86_64-linux/a.so", "elf"}});
    std::ifstream in{file, std::ios::binary};
    std::string const text{std::istreambuf_iterator<char>{in}, {}};
    for (std::size_t size = 0; size < text.size(); ++size) {
        auto const sut = Archive::open(std::as_bytes(std::span{text}.first(size)), "sut.fmu");
        if (sut && sut->has("modelDescription.xml")) {
            (void)sut->read("modelDescription.xml");
        }
        EXPECT_FALSE(sut && sut->entries().size() == 2) << size;
    }
}

TEST_F(AnArchive, WithoutADescriptionOrABinaryForThisMachineSaysWhatItHas) {
    auto const empty = Archive::open(zip({{"readme.txt"}}));
    ASSERT_TRUE(empty);
    auto const described = read_model_description(*empty, "sut.fmu");
    ASSERT_FALSE(described);
    EXPECT_THAT(described.error().message, HasSubstr("'modelDescription.xml' is missing"));

    auto const windows = Archive::open(zip({{"binaries/win64/a.dll"}, {"binaries/win32/a.dll"}}));
    ASSERT_TRUE(windows);
    ModelDescription description;
    description.file = "sut.fmu";
    description.co_simulation.emplace().identifier = "a";
    auto const binary = binary_of(*windows, description);
    ASSERT_FALSE(binary);
    EXPECT_THAT(binary.error().message, HasSubstr("no binary for this machine"));
    EXPECT_THAT(binary.error().message, HasSubstr("some for win32, win64"));
}

} // namespace
} // namespace gridspace::fmi
