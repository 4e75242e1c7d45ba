#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""slam_bench.py BUILD DATA --json FILE --markdown FILE [--seeds N]: localisation on public logs and in the simulator, against yardsticks.

DATA/intel and DATA/fr079 hold NAME.clf.xz, NAME.relations and NAME.times.csv.xz; what is absent is skipped and named. Every system reads
the same LCM log with the shipped parameters; only mount and no-return value differ by log. Floor plans are those of DATA/../semantic/plans. CPU seconds, so that other work on the machine counts little.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

import peers

LOGS = {"intel": ["--laser-x", "0.09"], "fr079": ["--laser-x", "0.08"]}  # where the laser sits on the recorded pose
# Logs without a truth: how they ran is told, how exact they are is not. What is not named here lies in DATA.
UNSCORED = {"wean 1": "wean/robotdata1.log.xz", "wean 3": "wean/robotdata3.log.xz", "wean 5": "wean/robotdata5.log.xz",
            "mines-urg exp1": "mines-urg/exp1.dat.xz", "mines-urg exp3": "mines-urg/exp3.dat.xz",
            "SENA": "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog"}
SYSTEMS = {
    "ModSLAM": [],
    "ModSLAM, no final polish": ["graph_optimizer.polish=false"],
    "ModSLAM, scan matching alone": ["launch.loops=false", "graph_optimizer.full_at=0", "graph_optimizer.polish=false"],
    "Pfister + TORO (the thesis)": ["scan_matcher.method=pfister", "graph_optimizer.method=toro", "graph_optimizer.polish=false"],
    "raw odometry": ["launch.estimator=odometry"],
}
ROUTES = [(route, noise) for route in ("A_safe_loop", "demo", "B_rooms_tight") for noise in ("raised", "official")]

SCANNERS = ["sick", "urg", "hokuyo-270"]
HERE = pathlib.Path(__file__).resolve().parent


class Bench:
    def __init__(self, build, data, work):
        self.bin, self.data, self.work = pathlib.Path(build) / "bin", pathlib.Path(data), pathlib.Path(work)

    def offline(self, log, name, settings):
        """One run of the whole chain; figures of its timing and its report."""
        out = self.work / name
        words = [word for setting in ["launch.semantics=false", *settings] for word in ("--set", setting)]
        peers.run([self.bin / "modslam-offline", log, "--out", out, *words])
        peers.run([self.bin / "modslam-report", out])
        timing = json.loads(re.search(r"\((.*)\);", (out / "timing.js").read_text(), re.S).group(1))
        summary = json.loads((out / "summary.json").read_text())
        return out, timing, summary

    def relations(self, name, path):
        scores = self.work / "relations.json"
        peers.run([self.bin / "modslam-evaluate", "--relations", self.data / name / f"{name}.relations", "--times",
             self.data / name / f"{name}.times.csv.xz", "--path", path, "--json", scores])
        return json.loads(scores.read_text())

    def icp_slam(self, name, log):
        """MRPT's icp-slam with its classic demo parameters. @return scores, CPU seconds, MB."""
        rawlog = self.work / f"{name}.rawlog"
        peers.run([self.bin / "to_rawlog", log, rawlog])
        poses, cpu_s, memory_mb = peers.run_peer("icp-slam", rawlog, self.work / f"icp-{name}")
        path = self.work / f"icp-{name}.tum"
        path.write_text(peers.tum(poses, self.work / name / "path_laser.tum", float(LOGS[name][1])))
        return self.relations(name, path), cpu_s, memory_mb


def verdict_words(summary):
    return ", ".join(f"{count} {word}" for word, count in summary["verdicts"]["scan_match"].items() if word != "first")


def loop_words(loops, is_raw=False):
    """Proposed / accepted / retracted, and how far the worst one in force is from the final map where it claims to know the place."""
    return "" if is_raw else f"{loops['proposed']} / {loops['accepted']} / {loops['retracted']}, {loops['worst_in_map']['where_known_m']:.2f} m"


def row_of(scores):
    relations, exact = scores["relations"]["all"], scores["relations"]["exact"]
    def cell(kind, unit):
        return f"{kind[unit]['mean']:.4f} ± {kind[unit]['std']:.4f}, {kind[unit]['max']:.2f}"
    return cell(relations, "translation_m"), cell(relations, "rotation_deg"), f"{exact['translation_m']['mean']:.4f}", f"{exact['rotation_deg']['mean']:.3f}"


def public_logs(bench, report, table):
    for name, mount in LOGS.items():
        source = bench.data / name / f"{name}.clf.xz"
        if not source.exists():
            print(f"skipped {name}: there is no {source}")
            continue
        log = bench.work / f"{name}.lcm"
        peers.run([bench.bin / "modslam-import", source, log, *mount])
        table += [f"\n### {name}\n", "| system | translation [m] mean ± std, max | rotation [deg] | exact stamps [m] | [deg] | CPU [s] | times real time | "
                  "ms per scan p50 / p99 | peak [MB] | loops proposed / accepted / retracted, worst against the map | verdicts |", "|---" * 11 + "|"]
        sensor_s = 0
        for system, settings in SYSTEMS.items():
            out, timing, summary = bench.offline(log, name if not settings else f"{name}-{len(report)}", settings)
            scores, loops = bench.relations(name, out / "path_laser.tum"), summary["loops"]
            sensor_s = timing["sensor_s"]
            report.append({"log": name, "system": system, "scores": scores, "timing": timing, "loops": loops, "verdicts": summary["verdicts"]})
            is_raw = system == "raw odometry"
            table.append("| " + " | ".join([system, *row_of(scores), f"{timing['cpu_s']:.1f}", f"{timing['times_real_time']:.0f}",
                         f"{timing['scan_ms']['p50']:.2f} / {timing['scan_ms']['p99']:.1f}", f"{timing['peak_memory_mb']:.0f}",
                         loop_words(loops, is_raw),
                         "" if is_raw else verdict_words(summary)]) + " |")
            print(table[-1], flush=True)
        try:
            scores, cpu_s, memory_mb = bench.icp_slam(name, log)
            report.append({"log": name, "system": "MRPT icp-slam", "scores": scores, "cpu_s": cpu_s, "peak_memory_mb": memory_mb})
            table.append("| " + " | ".join(["MRPT icp-slam (classic demo parameters, no loops)", *row_of(scores), f"{cpu_s:.1f}", f"{sensor_s / cpu_s:.0f}", "",
                                             f"{memory_mb:.0f}", "", ""]) + " |")
        except (RuntimeError, OSError, StopIteration) as error:
            table.append(f"| MRPT icp-slam | did not run: {str(error)[-120:]} |" + " |" * 9)
        print(table[-1], flush=True)


def unscored_logs(bench, report, table):
    table += ["\n### Logs without a truth\n", "| log | scans | odometry [m] | CPU [s] | times real time | ms per scan p50 / p99 | peak [MB] | "
              "loops proposed / accepted / retracted, worst against the map | verdicts |", "|---" * 9 + "|"]
    for name, place in UNSCORED.items():
        source = bench.data / place
        if not source.exists():
            print(f"skipped {name}: there is no {source}")
            continue
        log = bench.work / "unscored.lcm"
        told = subprocess.run([bench.bin / "modslam-import", source, log], check=True, capture_output=True, text=True).stdout
        _, timing, summary = bench.offline(log, "unscored", [])
        loops, odometry_m = summary["loops"], re.search(r"odometry ([0-9.]+) m", told).group(1)
        report.append({"log": name, "system": "ModSLAM", "odometry_m": float(odometry_m), "timing": timing, "loops": loops, "verdicts": summary["verdicts"]})
        table.append(f"| {name} | {timing['scans']} | {odometry_m} | {timing['cpu_s']:.1f} | {timing['times_real_time']:.0f} | "
                     f"{timing['scan_ms']['p50']:.2f} / {timing['scan_ms']['p99']:.1f} | {timing['peak_memory_mb']:.0f} | "
                     f"{loop_words(loops)} | {verdict_words(summary)} |")
        print(table[-1], flush=True)


def buildings(bench, report, table):
    """A tour through every room of every floor plan, with every scanner and raised odometry: what was not looked at when parameters were chosen."""
    plans = sorted((bench.data.parent / "semantic" / "plans").glob("*.json"))
    if not plans:
        print(f"skipped floor plans: none below {bench.data.parent}")
        return
    table += ["\n### Tours of floor plans, raised odometry\n", "| plan, scanner | way [m] | odometry's largest error [m] | largest error [m] | mean [m] | "
              "largest heading error [deg] | loops proposed / accepted / retracted | worst of them against the truth [m] | verdicts |", "|---" * 9 + "|"]
    world, log = bench.work / "tour.geojson", bench.work / "tour.lcm"
    for plan, scanner in [(plan, scanner) for scanner in SCANNERS for plan in plans]:
        tour = subprocess.run(["/usr/bin/python3", HERE / "semantics" / "toured_world.py", plan, world], capture_output=True, text=True)
        if tour.returncode != 0:
            print(f"skipped {plan.stem}: {tour.stderr.strip()[-120:]}")
            continue
        settings = [f"simulator.world={world}", "simulator.route=tour", "odometry.noise=raised", f"laser.model={scanner}"]
        peers.run([bench.bin / "modslam-simulate", log, *[word for setting in settings for word in ("--set", setting)]])
        _, timing, summary = bench.offline(log, "tour", [])
        error, loops = summary["error"]["aligned_at_first_pose"], summary["loops"]
        report.append({"plan": plan.stem, "scanner": scanner, "error": summary["error"], "odometry_error": summary["odometry_error"], "timing": timing,
                       "loops": loops, "verdicts": summary["verdicts"]})
        table.append(f"| {plan.stem}, {scanner} | {summary['path_length_m']:.0f} | {summary['odometry_error']['aligned_at_first_pose']['position_m']['max']:.1f} | "
                     f"{error['position_m']['max']:.3f} | {error['position_m']['mean']:.3f} | {error['heading_deg']['max']:.2f} | "
                     f"{loops['proposed']} / {loops['accepted']} / {loops['retracted']} | {loops['worst_in_truth']['where_known_m']:.2f} | {verdict_words(summary)} |")
        print(table[-1], flush=True)


def simulated(bench, seeds, report, table):
    table += ["\n### Simulated Apartment\n", "Largest position error of a run, path laid on the truth by its first pose; `raised` odometry drifts by metres.\n",
              "| route, noise | runs | odometry's largest error, median [m] | largest error: median [m] | worst run [m] | heading mean, median [deg] | "
              "loops in force, all runs | worst of them against the truth [m] | times real time, median |", "|---" * 9 + "|"]
    for route, noise in ROUTES:
        runs = []
        for seed in range(1, seeds + 1):
            log = bench.work / "sim.lcm"
            peers.run([bench.bin / "modslam-simulate", log, "--set", f"simulator.route={route}", "--set", f"odometry.noise={noise}", "--set", f"simulator.seed={seed}"])
            _, timing, summary = bench.offline(log, "sim", [])
            runs.append({"seed": seed, "error": summary["error"], "odometry_error": summary["odometry_error"], "timing": timing,
                         "loops": summary["loops"], "verdicts": summary["verdicts"]})
            log.unlink()
        report.append({"route": route, "noise": noise, "runs": runs})
        largest = [r["error"]["aligned_at_first_pose"]["position_m"]["max"] for r in runs]
        odometry = [r["odometry_error"]["aligned_at_first_pose"]["position_m"]["max"] for r in runs]
        heading = [r["error"]["aligned_at_first_pose"]["heading_deg"]["mean"] for r in runs]
        loops = [r["loops"]["accepted"] - r["loops"]["retracted"] for r in runs]
        worst_loop_m = max(r["loops"]["worst_in_truth"]["where_known_m"] for r in runs)
        table.append(f"| {route}, {noise} | {len(runs)} | {statistics.median(odometry):.2f} | {statistics.median(largest):.3f} | {max(largest):.3f} | "
                     f"{statistics.median(heading):.2f} | {sum(loops)} | {worst_loop_m:.2f} | {statistics.median(r['timing']['times_real_time'] for r in runs):.0f} |")
        print(table[-1], flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("data")
    parser.add_argument("--json", required=True)
    parser.add_argument("--markdown", required=True)
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    report, table = [], []
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(options.build, options.data, work)
        public_logs(bench, report, table)
        unscored_logs(bench, report, table)
        simulated(bench, options.seeds, report, table)
        buildings(bench, report, table)
    pathlib.Path(options.json).write_text(json.dumps(report, indent=1) + "\n")
    pathlib.Path(options.markdown).write_text("\n".join(table).lstrip("\n") + "\n")


if __name__ == "__main__":
    sys.exit(main())
