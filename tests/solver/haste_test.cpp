// SPDX-License-Identifier: GPL-3.0-or-later
// A frame has more substeps where a collider is fast for the cloth that it may meet; not where it takes the cloth
// along: a garment on a runner costs as much as on one who stands.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "solver_fixture.h"
#include "solver_impl.h"
#include "support/running_slab.h"

namespace geocloth {
namespace {

/// The cpu's, and how many substeps it was told to do with each cloth in the last frame that this was awake.
class Counter final : public SolverBackend {
 public:
  Counter(std::unique_ptr<SolverBackend> backend, std::vector<size_t>& substeps)
      : backend_(std::move(backend)), substeps_(substeps) {}
  void run_frame(const FrameInput& frame) override {
    substeps_.resize(frame.cloths.size());
    for (size_t c = 0; c < frame.cloths.size(); ++c)
      if (!frame.cloths[c].asleep) substeps_[c] = frame.substeps.size();
    backend_->run_frame(frame);
  }
  void wait() override { backend_->wait(); }
  void read_positions(uint32_t c, std::vector<shader::vec4>& out) override { backend_->read_positions(c, out); }
  void read_previous(uint32_t c, std::vector<shader::vec4>& out) override { backend_->read_previous(c, out); }
  void read_carry(uint32_t c, std::vector<shader::vec4>& out) override { backend_->read_carry(c, out); }
  void read_normals(uint32_t c, std::vector<shader::vec4>& out) override { backend_->read_normals(c, out); }
  void write_state(uint32_t c, std::span<const shader::vec4> x, std::span<const shader::vec4> before) override {
    backend_->write_state(c, x, before);
  }
  [[nodiscard]] std::optional<Whereabouts> whereabouts(uint32_t c) const override { return backend_->whereabouts(c); }
  void read_memory(uint32_t c, ClothMemory& out) override { backend_->read_memory(c, out); }
  void write_memory(uint32_t c, const ClothMemory& memory, const ClothFrame& pins) override {
    backend_->write_memory(c, memory, pins);
  }
  void read_found(FoundPoints& out) override { backend_->read_found(out); }
  void write_found(const FoundPoints& found) override { backend_->write_found(found); }
  void replace_topology(uint32_t c, ClothData data) override { backend_->replace_topology(c, std::move(data)); }
  void shift(const Vec3& by) override { backend_->shift(by); }
  void add_cloth(ClothData data) override { backend_->add_cloth(std::move(data)); }
  void remove_cloth(uint32_t cloth) override { backend_->remove_cloth(cloth); }
  void replace_inter(InterData inter) override { backend_->replace_inter(std::move(inter)); }
  float longest_way(uint32_t c, uint32_t word) override { return backend_->longest_way(c, word); }
  uint32_t left_behind(uint32_t c, uint32_t word) override { return backend_->left_behind(c, word); }
  void read_contacts(uint32_t c, std::vector<ContactSum>& out) override { backend_->read_contacts(c, out); }
  void fill_statistics(SolverStatistics& statistics) override { backend_->fill_statistics(statistics); }

 private:
  std::unique_ptr<SolverBackend> backend_;
  std::vector<size_t>& substeps_;
};

class Haste : public testing::Test {
 protected:
  Haste()
      : solver_(std::vector{test::describe(test::make_sheet(test::sheet_on_slab()), test::cloth_on_slab())},
                test::eight_substeps(), [&](SimulationData data) {
                  return std::make_unique<Counter>(make_cpu_backend(std::move(data), 1), substeps_);
                }) {
    solver_.set_colliders(std::vector{test::slab(0)}, true);
    for (int f = 0; f < 30; ++f) go(0);
  }

  /// A frame at this speed [m/s] and turn [degrees/s]. @returns its substeps
  size_t go(float speed, float turn = 0, float frame_time = test::kFrame) {
    way_ += speed * frame_time;
    turned_ += turn * frame_time;
    std::vector<Collider> all{test::slab(way_, turned_)};
    all[0].pose.translate.y -= below_;
    all.insert(all.end(), others_.begin(), others_.end());
    solver_.set_time_step(double{frame_time}, 8);
    solver_.set_colliders(all, false);
    solver_.step();
    return substeps_.front();
  }
  /// The most of the last few frames at one speed.
  size_t settle(float speed, float turn = 0, float frame_time = test::kFrame) {
    size_t most = 0;
    for (int f = 0; f < 90; ++f) {
      const size_t now = go(speed, turn, frame_time);
      if (f >= 80) most = std::max(most, now);
    }
    return most;
  }

  std::vector<size_t> substeps_;
  Solver::Impl solver_;
  std::vector<Collider> others_;
  float way_ = 0, turned_ = 0, below_ = 0;
};

TEST_F(Haste, EndsOnceTheClothRidesOnWhatIsFast) {
  EXPECT_EQ(go(0), 8U);
  EXPECT_GT(go(4), 8U);  // it was at rest
  EXPECT_EQ(settle(4), 8U);
}

TEST_F(Haste, EndsOnSomethingThatTurns) {
  EXPECT_GT(go(2, 240), 8U);
  EXPECT_EQ(settle(2, 240), 8U);
}

TEST_F(Haste, EndsThoughFramesTakeLongerAndShorter) {
  size_t last = 0;
  for (int f = 0; f < 120; ++f) last = go(4, 0, f % 2 == 0 ? 0.014F : 0.02F);
  EXPECT_LE(last, 12U);  // of 20 ms, as long as the 8 of a frame of 14 ms
}

TEST_F(Haste, ComesBackAtOnceWhenTheCarrierTurnsRound) {
  ASSERT_EQ(settle(4), 8U);
  EXPECT_GT(go(-4), 8U);
}

TEST_F(Haste, IsForOthersThatAreFastAsSeenFromTheCloth) {
  ASSERT_EQ(settle(4), 8U);
  Collider ball{"ball", Sphere{{}, 0.1F}, 0.3F, {}};
  ball.pose.translate = {way_ + 3, 0.1F, 0};
  others_ = {ball};
  go(4);  // it comes from nowhere, without a speed
  others_[0].pose.translate.x += 4 * test::kFrame;
  EXPECT_EQ(go(4), 8U);  // it flies beside it
  others_[0].pose.translate.x -= 4 * test::kFrame;
  EXPECT_GT(go(4), 8U);  // it flies towards it
}

TEST_F(Haste, StaysWhereWhatIsFastPassesTheCloth) {
  others_ = {test::slab(0)};  // the sheet lies on this one, the other runs below it
  below_ = 0.3F;
  go(0);  // placed, without a speed
  size_t least = 1000;
  for (int f = 0; f < 30; ++f) least = std::min(least, go(4));
  EXPECT_GT(least, 8U);
}

/// Curtains side by side, ten metres apart, and a ball that is thrown at the first one.
class Curtains : public testing::Test {
 protected:
  explicit Curtains(float inter_distance = 0) {
    cloths_.assign(2, test::describe(test::make_sheet({.nx = 21, .ny = 21})));
    for (uint32_t c = 0; c < 2; ++c) {
      cloths_[c].transform.translate = {10.F * static_cast<float>(c), 0, 0};
      if (inter_distance > 0) cloths_[c].inter_collision = InterCollision{inter_distance};
    }
  }

  /// Frames with a ball of this speed [m/s], of which the second one's positions come back.
  std::vector<Vec3> throw_at_first(float speed, std::vector<size_t>& most) {
    std::vector<size_t> substeps;
    Solver::Impl solver(cloths_, test::eight_substeps(), [&](SimulationData data) {
      return std::make_unique<Counter>(make_cpu_backend(std::move(data), 1), substeps);
    });
    most.assign(2, 0);
    Collider ball{"ball", Sphere{{}, 0.1F}, 0.3F, {{0, 0, -0.8F}, {}, 1}};
    for (int f = 0; f < 8; ++f) {
      for (uint32_t c = 0; c < 2 && pinned_; ++c)
        solver.set_pins(c, test::pins_at_rest(*cloths_[c].asset, "top", cloths_[c].transform.translate));
      ball.pose.translate.z += speed * test::kFrame;
      solver.set_colliders(std::vector{ball}, false);
      solver.step();
      for (uint32_t c = 0; c < 2; ++c) most[c] = std::max(most[c], substeps[c]);
    }
    std::vector<Vec3> positions;
    solver.read_positions(1, positions);
    return positions;
  }

  std::vector<ClothDesc> cloths_;
  bool pinned_ = true;
};

// A thrown ball would cost a level of many cloths all of its frame time otherwise.
TEST_F(Curtains, OnlyTheOneThatIsHitHasMoreSubsteps) {
  std::vector<size_t> thrown, still;
  const std::vector<Vec3> beside_thrown = throw_at_first(12, thrown), beside_still = throw_at_first(0, still);
  EXPECT_GT(thrown[0], 8U);
  EXPECT_EQ(thrown[1], 8U);
  EXPECT_EQ(still, (std::vector<size_t>{8, 8}));
  // Nor does it move otherwise because another one is hit.
  EXPECT_EQ(hash_state(*cloths_[1].asset, beside_thrown), hash_state(*cloths_[1].asset, beside_still));
}

// Its pins would let it swing to where the ball is, but it hangs still: with more substeps for nothing it would be less
// stretched all at once, and jump up by as much as 5 cm.
TEST_F(Curtains, NorHasOneThatTheBallFliesPast) {
  cloths_[1].transform.translate.x = 1.5F;
  std::vector<size_t> thrown, still;
  const std::vector<Vec3> beside_thrown = throw_at_first(12, thrown), beside_still = throw_at_first(0, still);
  EXPECT_GT(thrown[0], 8U);
  EXPECT_EQ(thrown[1], 8U);
  EXPECT_EQ(hash_state(*cloths_[1].asset, beside_thrown), hash_state(*cloths_[1].asset, beside_still));
}

// Where nothing is pinned only the device knows where cloth is; it has to be asked.
TEST_F(Curtains, NorHasOneThatFallsFreelyElsewhere) {
  pinned_ = false;
  cloths_[1].transform.translate.y = 3;
  std::vector<size_t> thrown, still;
  const std::vector<Vec3> beside_thrown = throw_at_first(12, thrown), beside_still = throw_at_first(0, still);
  EXPECT_GT(thrown[0], 8U);
  EXPECT_EQ(thrown[1], 8U);
  EXPECT_EQ(hash_state(*cloths_[1].asset, beside_thrown), hash_state(*cloths_[1].asset, beside_still));
}

/// A sheet falls freely, and a ball of 10 cm comes from afar.
class FreeSheet : public testing::Test {
 protected:
  /// Substeps of every frame, until the ball has gone so far [m].
  std::vector<size_t> meets(float from, float to, float speed) {
    const ClothDesc cloth = test::describe(test::make_sheet({.nx = 21, .ny = 21}));
    std::vector<size_t> substeps, all;
    SolverSettings settings = test::eight_substeps();
    settings.gravity = {0, -1, 0};
    Solver::Impl solver({&cloth, 1}, settings, [&](SimulationData data) {
      return std::make_unique<Counter>(make_cpu_backend(std::move(data), 1), substeps);
    });
    Collider ball{"ball", Sphere{{}, 0.1F}, 0.3F, {{0, 0, from}, {}, 1}};
    for (; (ball.pose.translate.z < to) == (speed > 0); ball.pose.translate.z += speed * test::kFrame) {
      solver.set_colliders(std::vector{ball}, false);
      solver.step();
      all.push_back(substeps.front());
    }
    solver.read_positions(0, positions_);
    return all;
  }
  std::vector<Vec3> positions_;
};

TEST_F(FreeSheet, HasMoreSubstepsOnlyWhenTheBallIsNear) {
  const std::vector<size_t> coming = meets(-8, 0.3F, 12);
  EXPECT_EQ(coming[1], 8U);
  EXPECT_EQ(coming[coming.size() / 2], 8U);  // 4 m away
  EXPECT_GT(coming[coming.size() - 3], 8U);
  float farthest = 0;
  for (const Vec3& p : positions_) farthest = std::max(farthest, p.z);
  EXPECT_GT(farthest, 0.25F);  // it is pushed, not passed
}

TEST_F(FreeSheet, HasAsManyAsEverOnceTheBallIsGone) {
  const std::vector<size_t> going = meets(0.3F, 12, 12);
  EXPECT_GT(going[1], 8U);
  EXPECT_EQ(going.back(), 8U);
}

class CurtainsThatMeet : public Curtains {
 protected:
  CurtainsThatMeet() : Curtains(0.05F) {}
};

// They meet substep by substep.
TEST_F(CurtainsThatMeet, HaveTheirSubstepsTogether) {
  std::vector<size_t> thrown;
  throw_at_first(12, thrown);
  EXPECT_GT(thrown[0], 8U);
  EXPECT_EQ(thrown[1], thrown[0]);
}

}  // namespace
}  // namespace geocloth
