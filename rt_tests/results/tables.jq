# What the tables share: numbers in print, rows of markdown, and the line that says where a table comes from.
# A page's marker names one of the functions at the end; its input is {machine, commands, inspect, bench, ...}.

# n significant digits, thousands apart: 0.06723 -> "0.067", 2612224 -> "2,612,224"
def grouped: tostring | split(".") as $parts
  | ($parts[0] | explode | reverse | [_nwise(3)] | map(reverse | implode) | reverse | join(","))
    + (if $parts[1] then "." + $parts[1] else "" end);
def magnitude: if . == 0 then 0 else (fabs | log10 | floor) end;
def zeros(n): [range(n) | "0"] | add // "";
def fixed($places):  # of a number that is not negative
  (pow(10; $places)) as $unit | (. * $unit + 0.5 | floor) as $whole
  | if $places == 0 then ($whole | grouped)
    else ($whole / $unit | floor | grouped) + "." + ($whole % $unit | tostring | zeros($places - length) + .) end;
def digits($n): ($n - 1 - magnitude) as $places | fixed([0, ([$places, 6] | min)] | max);
def percent: . * 100 | digits(2);
def megabytes: . / 1e6 | fixed(2) + " MB";

def row: "| " + (map(tostring) | join(" | ")) + " |";
def table(head): (head | row), (head | map("---") | row | gsub(" "; "")), (.[] | row);
def printed_by(input): "Printed by `\(.commands[input])` on \(.machine):", "";
def verdict(goal_met): if goal_met then "met" else "**missed**" end;

def size_of_the_bear: printed_by("inspect"), (.inspect | [
    ["nodes, those that move", "—", "\(.nodes | grouped), \(.domain_nodes | grouped)"],
    ["times fewer blocks than dense", "≥ 20", (.dense_blocks / .kept_blocks | digits(3))],
    ["bytes; times fewer than dense float32", "≥ 60", "\(.bytes | grouped); \(.dense_bytes / .bytes | digits(3))"],
    ["stored values of 4, 8, 16 bits, blocks", "—", "\(.bits | [."4", ."8", ."16"] | map(grouped) | join("; "))"],
    ["compression error of single columns: RMS, worst", "≤ 2, 10 %", "\(.rms_error | percent), \(.worst_column_error | percent) %"],
    ["worst force error of a patch", "≤ 5 %", "\(.worst_patch_force_error | percent) %"],
    ["arena for \(.budget.contacts) contacts", "≤ 4.01 MB", (.budget.arena_bytes | megabytes)]
  ] | table(["figure of the bear", "bar", "measured"]));

def wavelets_of_the_bear: printed_by("inspect"), (.inspect.wavelets | map([
    .wavelet, (.bytes | grouped), (.kept_blocks | grouped), (.rms_error | percent), (.worst_column_error | percent),
    (.worst_patch_force_error | percent), (.step_work / 1e6 | digits(3))
  ]) | table(["wavelet", "bytes", "blocks", "RMS, %", "worst column, %", "worst patch force, %", "declared work of a step, million units"]));

def frontier_of_the_bear: printed_by("inspect"), (.inspect | .dense_blocks as $dense | .frontier | map([
    (.threshold | digits(3)) + (if .chosen then " (the model)" else "" end), (.bytes | megabytes), ($dense / .kept_blocks | digits(3)),
    (.rms_error | percent), (.worst_column_error | percent), (.worst_patch_force_error | if . == null then "indefinite" else percent end),
    (.step_work / 1e6 | digits(3))
  ]) | table(["threshold", "file", "times fewer blocks", "RMS, %", "worst column, %", "worst patch force, %", "declared work of a step, million units"]));

def levels_of_the_bear: printed_by("inspect"), (.inspect.constraint_levels | map([
    .level, (.columns | grouped), (.kept_blocks | grouped), (.rms_error | percent), (.worst_column_error | percent),
    (.worst_patch_force_error | percent), (.field_error | percent), (.force_error | percent), (.cut_error | percent)
  ]) | table(["level", "columns", "blocks", "RMS, %", "worst column, %", "worst patch force, %", "field of what people do, %", "its forces, %", "field cut after level 0, %"]));

def patterns_of_the_bear: printed_by("inspect"), (.inspect.patterns | (map(.level) | max) as $finest
  | map(select(.level == $finest)) | group_by(.kind) | map(. as $kind | [.[0].kind] + ([1, 4, 16, 64] | map(. as $n
      | $kind | map(select(.contacts == $n)) | first // null
      | if . then "\(.field_error.worst | percent) / \(.field_peak.worst | percent) / \(.force_error.worst | percent)" else "" end)))
  | table(["kind", "1 contact", "4", "16", "64"]));

def fields_of_the_bear: printed_by("bench"), (.bench.field | map([
    .contacts, (.dense_us | digits(3)), (.field_us | digits(3)), (.step_us | digits(3)), (.fresh_step_us | digits(3)),
    (.field_dense_ratio | digits(2)), (.dense_ratio | digits(2)), (.cold_dense_ratio | digits(2)), (.backsolve_ratio | digits(3)),
    (.rms_error | percent), (.force_error | percent)
  ]) | table(["contacts", "dense sum, µs", "field, µs", "step, µs", "step with a fresh factor, µs", "× dense: field", "step", "cold step", "× back-substitution", "field RMS, %", "worst force, %"]));

def parts_of_the_bear: printed_by("bench"), (.bench | [
    ["contact forces alone, \(.force_only | map(.contacts | tostring) | join(", ")) contacts, cached factor", "≤ 0.3, 2 µs (1, 16)", "\(.force_only | map(.us | digits(2)) | join(", ")) µs"],
    ["one of \(.capacitance | map(.contacts | tostring) | join(", ")) nodes inserted; removed; fresh Cholesky", "—",
      "\(.capacitance | map(.insert_us | digits(2)) | join(", ")); \(.capacitance | map(.remove_us | digits(2)) | join(", ")); \(.capacitance | map(.factor_us | digits(2)) | join(", ")) µs"],
    ["an element of the capacitance matrix of so many", "≤ 60 ns (64)", "\(.capacitance | map(.extract_ns_per_block | digits(3)) | join(", ")) ns"],
    ["drift of those factors after \(.capacitance[0].updates | grouped) changes", "≤ 2e-6", "\(.capacitance | map(.drift * 1e7 | fixed(1) + "e-7") | join(", "))"],
    ["inverse transform; over a dense column", "≤ 0.6", "\(.transform_us | digits(3)) µs; \(.transform_over_dense_column | digits(2))"],
    ["time to create the body", "≤ 160 ms", "\(.create_ms | digits(2)) ms"]
  ] | table(["part of a step on the bear", "bar", "measured"]));

def roofline_of_the_bear: printed_by("bench"), (.bench.roofline | map(select(.contacts <= 64) | [
    .kernel, .contacts, (.bytes | grouped), (.flops | grouped), (.us | digits(2)), (.ratio | digits(2)), (.compute_ratio | digits(2)), .bound_by
  ]) | table(["kernel", "contacts", "bytes", "flops", "µs", "over its bytes", "over its arithmetic", "bound by"])),
  "", (.bench | "*Bytes* at the speed of a plain stream just long enough for them: \(.streams | map("\(.gb_per_s | digits(3)) GB/s out of \(.bytes / 1024 | fixed(0)) KB") | join(", ")); *arithmetic* at \(.gflops | digits(3)) GFlop/s.");

def stress_of_the_bear: printed_by("stress"), (.stress | [
    ["cycles; verdict", "HELD", "\(.cycles | grouped); \(.verdict)"],
    ["work overruns, wrong answers, allocations, locks, system calls, page faults", "0", ([.work_overruns, .wrong_answers, .allocations, .locks, .syscalls, .minor_faults] | map(tostring) | join(", "))],
    ["worst work of a step; declared; declared over worst", "≤ 1.2", "\(.worst_work | grouped); \(.declared_work | grouped); \(.declared_over_worst | digits(3))"],
    ["digest of all answers", "—", "`\(.digest)`"]
  ] | table(["adversarial cycles on the bear", "bar", "measured"]));

def loop_of_the_bear: printed_by("loop"), (.loop | [
    ["virtual time, rate; verdict", "HELD", "\(.seconds) s, \(.rate | grouped) Hz; \(.verdict)"],
    ["missed cycles, allocations", "0", "\(.misses), \(.allocations)"],
    ["worst work of a cycle; budget; least admissible budget", "≤ budget", "\(.worst_work | grouped); \(.budget_work | grouped); \(.least_work | grouped)"],
    ["step, wall time: median, 99 of 100, worst", "≤ \(1e6 / .rate) µs", "\([.step_us.median, .step_us.p99, .step_us.max] | map(digits(3)) | join(", ")) µs"],
    ["digest of the run", "equal", "`\(.digest)`"]
  ] | table(["the demo's control loop", "bar", "measured"]));

def scorecard_of_the_bear: "On \(.machine):", "", (
  def goal(name; bar; value; met; input): [name, bar, value, if met then "met" else "**missed**" end, "`\(.commands[input])`"];
  def field(n): .bench.field | map(select(.contacts == n)) | first;
  def finest: .inspect.patterns | (map(.level) | max) as $finest | map(select(.level == $finest and (.kind | IN("alternating", "random") | not)));
  (.inspect.dense_blocks / .inspect.kept_blocks) as $blocks | (.inspect.dense_bytes / .inspect.bytes) as $bytes
  | (finest | map(.field_error.worst) | max) as $field | (finest | map(.field_peak.worst) | max) as $peak
  | (field(16).field_dense_ratio) as $few | (field(64).field_dense_ratio) as $many
  | (.stress | [.work_overruns, .wrong_answers, .allocations, .locks, .syscalls, .minor_faults]) as $faults
  | [
    goal("blocks, bytes against dense float32"; "≥ 20, 60 times fewer"; "\($blocks | digits(3)), \($bytes | digits(3))"; $blocks >= 20 and $bytes >= 60; "inspect"),
    goal("compression error: field, worst node of what people do"; "≤ 5, 10 %"; "\($field | percent), \($peak | percent) %"; $field <= 0.05 and $peak <= 0.1; "inspect"),
    goal("compression error: worst force of a patch"; "≤ 5 %"; "\(.inspect.worst_patch_force_error | percent) %"; .inspect.worst_patch_force_error <= 0.05; "inspect"),
    goal("mesh error: pressed patches, beyond quadratic elements"; "≤ 5 %, as `patch_force` asks"; "\(.inspect.mesh_error.force | percent) %"; .inspect.mesh_error.force <= 0.05; "inspect"),
    goal("arena of 16 contacts and 8 factors"; "≤ 4.01 MB"; (.inspect.budget.arena_bytes | megabytes); .inspect.budget.arena_bytes <= 4.01e6; "inspect"),
    goal("field of 16, 64 contacts over dense sums"; "≥ 4, 8"; "\($few | digits(2)), \($many | digits(2))"; $few >= 4 and $many >= 8; "bench"),
    goal("step of 16 contacts against a sparse back-substitution"; "≥ 100"; (field(16).backsolve_ratio | digits(3)); field(16).backsolve_ratio >= 100; "bench"),
    goal("adversarial cycles: overruns, wrong answers, allocations, locks, system calls, page faults"; "0"; "\($faults | map(tostring) | join(", ")) of \(.stress.cycles | grouped)"; ($faults | add) == 0; "stress"),
    goal("declared work over the worst of those cycles"; "≤ 1.2"; (.stress.declared_over_worst | digits(3)); .stress.declared_over_worst <= 1.2; "stress"),
    goal("10 s at 1 kHz: missed cycles, allocations"; "0"; "\(.loop.misses), \(.loop.allocations)"; .loop.misses + .loop.allocations == 0; "loop")
  ] | table(["goal", "bar", "value", "", "command"]));
