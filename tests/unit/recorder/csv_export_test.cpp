// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/export/csv_export.hpp"
#include "recorder/mcap/mcap_writer.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>
#include <gmock/gmock.h>

namespace gridspace {
namespace {

TEST(CsvExport, OfTopicsWhoseNamesBecomeTheSameHasAFileForEach) {
    TemporaryFolder const folder;
    auto const recording = folder.path() / "data.mcap";
    auto writer = mcap::Writer::create(recording, {});
    ASSERT_TRUE(writer);
    auto const schema = writer->add_schema("S", "omgidl", "struct S { long n; };");
    std::vector<std::byte> cdr(8);
    cdr[1] = std::byte{1};
    std::uint32_t number = 0;
    for (char const* topic : {"rt/a", "rt_a", "rt_a_2"}) {
        auto const channel = writer->add_channel(schema, topic, "cdr", {{"process", "one, \"two\"\n"}});
        cdr[4] = static_cast<std::byte>(++number);
        ASSERT_TRUE(writer->write(channel, 1, 1'000'000'000, cdr));
    }
    ASSERT_TRUE(writer->close());

    auto const out = export_csv(recording, 0, folder.path() / "csv");
    ASSERT_TRUE(out) << out.error().message;
    std::vector<std::string> names, texts;
    for (auto const& file : out->files) {
        std::ifstream in{file};
        names.push_back(file.filename().string());
        texts.emplace_back(std::istreambuf_iterator<char>{in}, std::istreambuf_iterator<char>{});
    }
    EXPECT_THAT(names, testing::ElementsAre("rt_a.csv", "rt_a_2.csv", "rt_a_2_2.csv"));
    EXPECT_THAT(texts, testing::ElementsAre("time_s,process,n\n1,\"one, \"\"two\"\"\n\",1\n",
                                            "time_s,process,n\n1,\"one, \"\"two\"\"\n\",2\n",
                                            "time_s,process,n\n1,\"one, \"\"two\"\"\n\",3\n"));
}

} // namespace
} // namespace gridspace
