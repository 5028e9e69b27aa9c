// SPDX-License-Identifier: GPL-3.0-or-later
// What scripts read from `geocloth bench`: its JSON, and the comparison of two of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

json bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"bench", "--quick", "--json", "-q", "--backend", "cpu"});
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  return json::parse(result.out);
}

TEST(Bench, JsonHasTheKeysThatScriptsReadAndNumbersThatCanBe) {
  const json report = bench({"--scene", "swing", "--size", "32", "--threads", "1", "--substeps", "4"});
  for (const char* key : {"cpu", "cores", "copy_gb_per_s", "gflops"})
    EXPECT_TRUE(report["machine"].contains(key)) << key;
  EXPECT_GT(report["machine"]["copy_gb_per_s"], 0.1);
  EXPECT_GT(report["machine"]["gflops"], 0.1);
  ASSERT_EQ(report["results"].size(), 1U);
  const json& result = report["results"][0];
  for (const char* key :
       {"scene", "backend", "device", "path", "threads", "width", "height", "particles", "springs", "substeps",
        "ms_per_frame", "springs_per_second", "roofline_share", "stretch", "memory_bytes", "passes_ms"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  EXPECT_EQ(result["scene"], "swing");
  EXPECT_EQ(result["width"], 32);
  EXPECT_EQ(result["height"], 32);
  EXPECT_EQ(result["particles"], 32 * 32);
  // Structural 2 n (n - 1), shear 2 (n - 1)^2, bending 2 n (n - 2).
  EXPECT_EQ(result["springs"], 2 * 32 * 31 + 2 * 31 * 31 + 2 * 32 * 30);
  const double solves_per_frame = result["springs"].get<double>() * 4;
  const double ms = result["ms_per_frame"];
  EXPECT_NEAR(result["springs_per_second"].get<double>() * ms / 1e3, solves_per_frame, 1e-6 * solves_per_frame);
  EXPECT_GT(result["roofline_share"], 0);
  EXPECT_GT(result["memory_bytes"], 32 * 32 * 60);
  EXPECT_GE(result["stretch"]["max"], result["stretch"]["mean"]);
  EXPECT_GT(result["stretch"]["mean"], 0.9);
}

// `--backend cpu --device llvm` measured the GPU.
TEST(Bench, ADeviceOfAnotherNameIsNotMeasured) {
  const std::string name = json::parse(run_program({"devices", "--json"}).out)["devices"][0]["name"];
  const json result = bench({"--scene", "zeller", "--size", "16", "--threads", "1", "--device", name})["results"][0];
  EXPECT_EQ(result["device"], name);
  EXPECT_EQ(result["backend"], "cpu");
  EXPECT_EQ(run_program({"bench", "--quick", "-q", "--backend", "cpu", "--device", "Voodoo 2"}).status, 1);
}

TEST(Bench, GarmentsAndCrowdsCountAllTheirCloth) {
  const json garment = bench({"--scene", "garment", "--size", "24", "--threads", "1"})["results"][0];
  EXPECT_NEAR(garment["particles"].get<double>(), 24 * 24, 0.2 * 24 * 24);
  EXPECT_LT(garment["particles"], garment["width"].get<int>() * garment["height"].get<int>());
  const json crowd = bench({"--scene", "crowd", "--size", "8", "--threads", "1"})["results"][0];
  EXPECT_EQ(crowd["particles"], crowd["cloths"].get<int>() * 64);
}

// Nothing else in the benchmark measures a field anew in every frame.
TEST(Bench, ABodyOfTrianglesWalksToo) {
  const json body = bench({"--scene", "body", "--size", "24", "--substeps", "4", "--threads", "1"})["results"][0];
  EXPECT_NEAR(body["particles"].get<double>(), 24 * 24, 0.2 * 24 * 24);
  EXPECT_GT(body["passes_ms"]["collide"], 0);
  EXPECT_LT(body["stretch"]["p99"], 1.5);  // the dress goes with the body
}

// A body that walks once took twenty times as long as one who stands.
TEST(Bench, AWalkIsPlayed) {
  const json walk = bench({"--scene", "walk", "--size", "24", "--substeps", "4", "--threads", "1"})["results"][0];
  EXPECT_NEAR(walk["particles"].get<double>(), 24 * 24, 0.2 * 24 * 24);
  EXPECT_GT(walk["passes_ms"]["collide"], 0);
  EXPECT_LT(walk["stretch"]["p99"], 1.5);  // the dress goes with the body
}

// Finding neighbours once took nine tenths of a heap's time.
TEST(Bench, AHeapCollidesWithItself) {
  const json heap = bench({"--scene", "heap", "--size", "24", "--substeps", "4", "--threads", "1"})["results"][0];
  EXPECT_NEAR(heap["particles"].get<double>(), 24 * 24, 0.2 * 24 * 24);
  EXPECT_GT(heap["passes_ms"]["self_find"], 0);
  EXPECT_GT(heap["passes_ms"]["self_push"], 0);
  EXPECT_LT(heap["stretch"]["p99"], 1.5);
}

TEST(Bench, CompareSaysHowMuchFasterTheSecondReportIs) {
  const TemporaryFolder folder;
  const json one = bench({"--scene", "zeller", "--size", "16", "--threads", "1"});
  json two = one;
  two["results"][0]["ms_per_frame"] = 0.5 * one["results"][0]["ms_per_frame"].get<double>();
  const std::string before = folder.write("before.json", one.dump()), after = folder.write("after.json", two.dump());
  const ProgramResult result = run_program({"bench", "--compare", before, after});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("zeller"));
  EXPECT_THAT(result.out, HasSubstr("2.00x"));
  EXPECT_THAT(result.out, HasSubstr("1 cases"));
}

TEST(Bench, CompareRefusesWhatIsNoReport) {
  const TemporaryFolder folder;
  const std::string good =
      folder.write("good.json", bench({"--scene", "zeller", "--size", "8", "--threads", "1"}).dump());
  for (const char* text :
       {"", "[]", "{\"machine\": {}}", "{\"machine\": {\"copy_gb_per_s\": 1, \"gflops\": 1}, \"results\": []}"}) {
    const ProgramResult result = run_program({"bench", "--compare", good, folder.write("bad.json", text)});
    EXPECT_EQ(result.status, 1) << text;
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, HasSubstr("bad.json"));
  }
}

}  // namespace
}  // namespace geocloth::test
