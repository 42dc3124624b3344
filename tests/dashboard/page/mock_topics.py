"""The data of the mock lab: plausible numbers in the form of docs/dashboard.md."""

import math
import random
import time

WIDTH, HEIGHT, RADIUS = 120.0, 90.0, 3.75
PROGRAMS = [
    {"name": "abp", "description": "constant speed, random turning", "text": "v 3 cm/s, ε 0.5 s, η 3 rad/s", "color": 0, "rgb": "#0072B2"},
    {"name": "rtp", "description": "run and tumble", "text": "v 8 cm/s, γ 1 1/s, τt 0.2 s", "color": 1, "rgb": "#D55E00"},
    {"name": "bp", "description": "Brownian", "text": "V 7 cm/s, ε 0.2 s", "color": 2, "rgb": "#009E73"},
]
SPEED = [3.0, 8.0, 1.0]
TURN = [0.75, 1.2, 3.0]  # [rad^2/s]
STEPS = [("dark", 60.0), ("half <b>light</b>", 120.0), ("bright", 120.0)]
REVERSING, STOPPED, TUMBLING, CONTACT_ROBOT, CONTACT_WALL = 1, 2, 16, 32, 64
THUMBNAIL = ('<svg xmlns="http://www.w3.org/2000/svg" width="120" height="90">'
             '<rect width="120" height="90" fill="white"/>'
             '<path d="M10 80 L40 30 L70 60 L110 10" fill="none" stroke="#0072B2"/></svg>')
RUNS = [
    {"name": "abp-20260101T120000Z", "experiment": "abp", "start_utc": "2026-01-01T12:00:00Z",
     "duration_s": 3600,
     "marked": False, "lost": 0, "verdicts": [{"program": "abp", "verdict": "agrees",
                                               "max_z": 1.9}],
     "thumbnail": "trajectory_abp.svg", "report": True},
    {"name": "swarm-20260102T120000Z", "experiment": "swarm", "start_utc": "2026-01-02T12:00:00Z",
     "duration_s": 1200, "marked": True, "lost": 17,
     "verdicts": [{"program": "abp", "verdict": "disagrees", "max_z": 6.1},
                  {"program": "rtp", "verdict": "undecided", "max_z": None}],
     "thumbnail": "figures/trajectory abp.svg", "report": True},
    {"name": "broken-20260103T120000Z", "experiment": None, "start_utc": None, "duration_s": None,
     "marked": None,
     "lost": None, "verdicts": [], "thumbnail": None, "report": False,
     "problem": "summary.json is cut short"},
]
CAMPAIGNS = [
    {"name": "night-20260104T200000Z", "updated_utc": "2026-01-04T23:00:00Z", "total": 30, "done": 12,
     "failed": 1, "running": True, "live": True, "seconds_left": 7200, "page": True},
    {"name": "scan-20260103T200000Z", "updated_utc": None, "total": 0, "done": 0, "failed": 0,
     "running": False, "live": False, "seconds_left": None, "page": False},
]
FILM_CLIP = {"fps": 24, "t_s": [2.5 * k for k in range(240)]}
EXPERIMENTS = [
    {"file": "experiments/abp.toml", "name": "abp", "description": "Active Brownian particle",
     "shipped": True},
    {"file": "mine.toml", "name": "mine", "description": "<i>my own</i>", "shipped": False},
]


def now_us():
    return int(time.time() * 1e6)


class World:
    def __init__(self, robots, replay):
        self.random = random.Random(1)
        self.replay = replay
        self.life = 0.0
        self.ticks = 0
        self.start_us = now_us()
        self.robots = [self.robot(i + 1) for i in range(robots)]
        self.latched = False
        self.stop_state = {"state": "free", "by": None, "reason": None, "total": robots,
                           "confirmed": robots,
                           "unconfirmed": [], "took_ms": None}
        self.deaf = []
        self.stopped_at = 0.0
        self.paused = False
        self.marks = []
        self.end = None
        self.manual = None
        self.speed = 1.0
        self.jumps = 0
        self.history = {p["name"]: [] for p in PROGRAMS}

    def runs(self):
        """The past runs. The one that is played has a film."""
        played = dict(RUNS[1], name=self.lab()["run"], film=True)
        return RUNS + [played] if self.replay else RUNS

    def robot(self, number):
        draw = self.random.uniform
        return {"id": number, "x": draw(8, WIDTH - 8), "y": draw(8, HEIGHT - 8), "a": draw(-math.pi,
                                                                                           math.pi),
                "program": number % 3, "flags": 0,
                "origin": 3 if self.replay else 1 + (number % 4 != 0),
                "trail": []}

    def advance(self, step):
        self.life += step
        self.ticks += 1
        for robot in self.robots:
            robot["flags"] = 0
            if self.latched and robot["id"] not in self.deaf:
                robot["flags"] = STOPPED
                continue
            k = robot["program"]
            robot["a"] += self.random.gauss(0, math.sqrt(2 * TURN[k] * step))
            robot["x"] += SPEED[k] * step * math.cos(robot["a"])
            robot["y"] += SPEED[k] * step * math.sin(robot["a"])
            if not (RADIUS < robot["x"] < WIDTH - RADIUS and RADIUS < robot["y"] < HEIGHT - RADIUS):
                robot["x"] = min(max(robot["x"], RADIUS), WIDTH - RADIUS)
                robot["y"] = min(max(robot["y"], RADIUS), HEIGHT - RADIUS)
                robot["a"] += math.pi * 0.9
                robot["flags"] |= REVERSING | CONTACT_WALL
            if k == 1 and self.random.random() < 0.03:
                robot["flags"] |= TUMBLING
        if self.ticks % 5 == 0:
            for robot in self.robots:
                robot["trail"] = (robot["trail"] + [round(robot["x"], 2), round(robot["y"],
                                                                                2)])[-480:]

    # --- topics

    def lab(self):
        script, at = [], 0.0
        for label, lasts in STEPS:
            script.append({"label": label, "at_s": at, "ramp_s": 0, "until": None})
            at += lasts
        return {"run": "swarm-20260104T120000Z", "name": "swarm",
                "description": "Three programs in one arena",
                "version": "0.0", "replay": self.replay, "arena_cm": [WIDTH, HEIGHT],
                "robot_diameter_cm": 2 * RADIUS, "duration_s": at,
                "robots": [{"id": r["id"],
                            "body": "real" if r["origin"] == 1 else "sim"} for r in self.robots],
                "programs": PROGRAMS, "script": script,
                "file": "fileversion = 1\nname = \"swarm\"\n",
                "bands": [{"low": 0.1, "high": 0.4, "program": "abp"}, {"low": 0.4, "high": 1,
                                                                        "program": "rtp"}]}

    def frame(self):
        return {"t_us": self.start_us + int(self.life * 1e6),
                "robots": [[r["id"], round(r["x"], 2), round(r["y"], 2),
                            round(math.degrees(r["a"]) % 360, 1),
                            r["program"], r["flags"], r["origin"], 0.9,
                            5.0 if r["id"] == 5 else 0.03]
                           for r in self.robots],
                "unidentified": [[60.0, 5.0, 0.0]] if self.life % 10 < 5 else []}

    def often(self):
        topics = [("stop", self.stop()), ("script", self.script())]
        if self.replay:
            topics.append(("player", {"at_s": self.life, "length_s": 600.0, "speed": self.speed,
                                      "paused": self.paused, "jumps": self.jumps}))
        return topics

    def step(self):
        at = self.life
        for number, (_, lasts) in enumerate(STEPS):
            if at < lasts:
                return number, lasts - at
            at -= lasts
        return len(STEPS) - 1, 0.0

    def script(self):
        number, left = self.step()
        total = sum(lasts for _, lasts in STEPS)
        phase = "ended" if self.end else "paused" if self.paused else "script"
        return {"phase": phase, "elapsed_s": round(self.life, 2), "left_s": max(0.0,
                                                                                total - self.life),
                "at_most": True, "step": number, "label": STEPS[number][0], "step_left_s": left,
                "stop": "D_r of abp to 5 %: at 11 %, in about 4 min"}

    def stop(self):
        state = self.stop_state
        if state["state"] == "stopping":
            passed = self.life - self.stopped_at
            sure = [r["id"] for r in self.robots if r["id"] not in self.deaf]
            done = sure if passed > 0.08 else sure[: len(sure) // 2]
            state["confirmed"] = len(done)
            state["unconfirmed"] = [r["id"] for r in self.robots if r["id"] not in done]
            if not state["unconfirmed"]:
                state.update(state="stopped", took_ms=84)
        return dict(state)

    def each_second(self, pools):
        topics = [("robots", self.robot_rows()), ("light", self.light()), ("timeline",
                                                                           self.timeline()),
                  ("health", self.health()), ("delivery", self.delivery()),
                  ("camera", {"state": "ok", "width_px": 1280, "height_px": 960, "fps": 30.0,
                              "trouble": "",
                              "picture": True})]
        if pools:
            for k, program in enumerate(PROGRAMS):
                name = program["name"]
                topics.append((f"pool/{name}", self.pool(k)))
                topics.append((f"history/{name}", self.past(k)))
                topics.append((f"crowd/{name}", self.crowd(k)))
            topics.append(("crowd", self.crowd()))
            topics.append(("runtimes/rtp", {"program": "rtp", "gamma_per_s": 1.0,
                                            "edges_s": [0.25 * i for i in range(17)], "runs": 400,
                                            "mean_s": 1.02,
                                            "counts": [round(100 * math.exp(-0.25 * i))
                                                       for i in range(16)]}))
        return topics

    def robot_rows(self):
        return [{"id": r["id"], "origin": r["origin"],
                 "owner": "robot_bridge" if r["origin"] == 1 else "sim_svc",
                 "program": PROGRAMS[r["program"]]["name"], "battery_V": 7.9 - 0.1 * (r["id"] % 12),
                 "battery_low": r["id"] % 12 == 11,
                 "link_sent": 1000, "link_received": 990, "link_errors": 3 if r["id"] == 4 else 0,
                 "age_s": 0.03, "flags": r["flags"], "light": 0.4, "reversals": 3, "tumbles": 8,
                 "stopped": bool(r["flags"] & STOPPED)} for r in self.robots]

    def light(self):
        number, _ = self.step()
        return {"version": self.ticks // 100 + (0 if self.manual is None else 1000000),
                "columns": 120, "rows": 90,
                "mean": 0.4 if self.manual is None else self.manual, "label": STEPS[number][0],
                "commander": "lab" if self.manual is None else "dashboard",
                "manual": self.manual is not None,
                "moving": False, "display": "window", "trouble": ""}

    def light_raster(self):
        if self.manual is not None:
            return bytes([round(255 * self.manual)]) * (120 * 90)
        return bytes((230 if (c - 60) ** 2 + (45 - r) ** 2 < 30 ** 2 else 60)
                     for r in range(90) for c in range(120))

    def timeline(self):
        steps, at = [], self.start_us
        for number in range(self.step()[0] + 1):
            label, lasts = STEPS[number]
            steps.append({"number": number, "label": label, "commanded_us": at,
                          "presented_us": at + 21000,
                          "seen_us": at + 64000, "first_acted_us": at + 90000,
                          "last_acted_us": at + 180000,
                          "robots_acted": len(self.robots), "robots_expected": len(self.robots),
                          "ended_by": ""})
            at += int(lasts * 1e6)
        return {"start_us": self.start_us, "steps": steps, "steps_before": 0, "marks": self.marks,
                "faults": [{"t_us": self.start_us + 9000000,
                            "text": "sim_svc fell silent for 2.1 s"}]
                if self.life > 10 else [], "end": self.end}

    def delivery(self):
        return {"steps": 2, "delays": [{"until": u, "count": 2, "p50_s": d, "p95_s": 1.4 * d,
                                        "p99_s": 2 * d,
                                        "max_s": 2.1 * d} for u, d in
                                       [("presented", 0.021), ("seen", 0.064), ("first acted",
                                                                                0.09),
                                        ("last acted", 0.18)]]}

    def health(self):
        service = {"state": "ok", "origin": "sim", "host": "bench", "pid": 4711, "version": "0.0",
                   "uptime_s": self.life, "age_s": 0.4, "cpu_percent": 3.2, "memory_MB": 12.0,
                   "last_error": "",
                   "lost": 0, "decode_errors": 0}
        names = ["sim_svc", "projector_ctl", "tracker_svc", "analyzer", "robot_bridge", "dashboard"]
        return {"services": [dict(service, name=n) for n in names],
                "streams": [{"channel": c, "sender": s, "rate_Hz": r, "age_s": 0.02,
                             "received": self.ticks,
                             "lost": 0} for c, s, r in [("ROBOT_STATUS", "sim_svc", 20.0),
                                                        ("TRACKED_FRAME", "tracker_svc", 30.0)]],
                "not_understood": [], "tracker": {"frames": self.ticks, "dropped": 0, "fps": 29.9},
                "links": [{"peer": "bench2", "state": "up", "delay_ms": 0.4}],
                "advice": [{"level": "warn", "what": "robot 11: battery at 6.7 V",
                            "do": "charge it"},
                           {"level": "error", "what": "sim_svc fell silent for 2.1 s",
                            "do": "look at its last error; lab spy shows who speaks"}],
                "server": {"viewers": 1, "refused": {"host": 0, "token": 2}, "cpu_percent": 1.0,
                           "memory_MB": 20.0}}

    # --- curves

    def laws(self, k, lag):
        tau, v = 1 / TURN[k], SPEED[k]
        return 2 * v * v * tau * (lag - tau * (1 - math.exp(-lag / tau))) + 0.002, 2 * TURN[k] * lag

    def pool(self, k, seed=0):
        draw = random.Random(100 * seed + k + int(self.life))
        lags = [0.1 * 1.25 ** i for i in range(24)]
        trust = 1 / math.sqrt(1 + self.life)
        curves = []
        for which, (name, unit) in enumerate([("msd", "cm^2"), ("angular_msd", "rad^2")]):
            exact = [self.laws(k, lag)[which] for lag in lags]
            sigma = [e * (0.02 + 0.05 * trust) * (1 + lag / 10) for e, lag in zip(exact, lags)]
            curves.append({"name": name, "unit": unit, "lag": lags, "exact": exact, "sigma": sigma,
                           "value": [draw.gauss(e, s) for e, s in zip(exact, sigma)],
                           "paper": [1.08 * e for e in exact],
                           "windows": [1000 // (i + 1) for i in range(24)],
                           "biased": [1 if i > 20 else 0 for i in range(24)]})
        lags = [0.5 * i for i in range(1, 25)]
        exact = [math.exp(-lag * TURN[k] / SPEED[k]) for lag in lags]
        curves.append({"name": "C_l", "unit": "1", "lag_cm": lags, "exact": exact,
                       "sigma": [0.03] * 24,
                       "value": [draw.gauss(e, 0.03) for e in exact], "paper": [None] * 24,
                       "windows": [100] * 24, "biased": [0] * 24})
        return {"program": PROGRAMS[k]["name"], "observed_s": 6 * self.life,
                "segments": 12, "reversals": 8, "contact_share": 0.031, "verdict": ["agrees",
                                                                                    "undecided",
                                                                                    "disagrees"][k],
                "max_z": [1.7, None, 5.2][k], "curves": curves, "estimates": self.estimates(k,
                                                                                            draw)}

    def crowd(self, program=None):
        mine = [r for r in self.robots if program is None or r["program"] == program]
        draw = random.Random(int(self.life))
        names = [("polar_order", "", 0.21), ("hexatic_order", "", 0.44), ("largest_cluster", "", 3.4),
                 ("speed", "cm/s", 4.2), ("contact_time", "s", 1.8), ("bimodality", "", None)]
        x = [0.25 + 0.5 * i for i in range(60)]
        g = [0.0 if r < 2 * RADIUS else 1 + math.exp(-(r - 2 * RADIUS) / 4) for r in x]
        t = [2.0 * i for i in range(int(self.life / 2) + 1)]
        series = {"now": [0.2 + 0.1 * math.sin(0.1 * s) for s in t], "low": [0.15 for _ in t],
                  "high": [0.25 for _ in t]}
        return {"program": "" if program is None else PROGRAMS[program]["name"],
                "observed_s": self.life, "robots": len(mine),
                "observables": [{"name": n, "unit": u, "now": v, "mean": v,
                                 "sigma": v and v / 20, "low": v and 0.9 * v,
                                 "high": v and 1.1 * v} for n, u, v in names],
                "curves": [{"name": "pair_distribution", "x_unit": "cm", "unit": "", "x": x,
                            "value": g, "low": [0.9 * v for v in g],
                            "high": [1.1 * v for v in g]}],
                "history": {"t_s": t, "polar_order": series,
                            "largest_cluster": {k: [10 * v for v in values]
                                                for k, values in series.items()}},
                "members": [[r["id"], draw.randrange(4), 0.8 * draw.random(), draw.random()]
                            for r in self.robots] if program is None else []}

    def estimates(self, k, draw):
        sigma = 0.2 * TURN[k] / math.sqrt(1 + self.life)
        value = draw.gauss(TURN[k], sigma)
        made = [{"name": "D_r", "unit": "rad^2/s", "value": value, "sigma": sigma,
                 "low": value - 2 * sigma,
                 "high": value + 2 * sigma, "theory": TURN[k], "note": "slope of the angular MSD"},
                {"name": "v", "unit": "cm/s", "value": SPEED[k] * 1.01, "sigma": 0.02,
                 "low": SPEED[k] * 0.99,
                 "high": SPEED[k] * 1.03, "theory": SPEED[k], "note": ""},
                {"name": "D_t", "unit": "cm^2/s", "value": None, "sigma": None, "low": None,
                 "high": None,
                 "theory": None, "note": "not determined: too little data"}]
        return made

    def past(self, k):
        points = self.history[PROGRAMS[k]["name"]]
        points.append((self.life, self.estimates(k, self.random)))
        del points[:-600]
        names = [(e["name"], e["unit"], e["theory"]) for e in points[0][1]]
        return {"program": PROGRAMS[k]["name"], "t_s": [t for t, _ in points],
                "estimates": [{"name": n, "unit": u, "theory": th, "value": [e[i]["value"] for _,
                                                                             e in points],
                               "low": [e[i]["low"] for _, e in points], "high": [e[i]["high"] for _,
                                                                                 e in points]}
                              for i, (n, u, th) in enumerate(names)]}

    def compare(self, runs):
        return [{"run": run, "program": PROGRAMS[0]["name"], "curves": self.pool(0,
                                                                                 i + 1)["curves"],
                 "estimates": self.pool(0, i + 1)["estimates"]} for i, run in enumerate(runs)]

    # --- queries and requests

    def query(self, what, which):
        if what == "trails":
            return {"step_s": 0.25, "robots": {str(r["id"]): r["trail"] for r in self.robots}}
        robot = next((r for r in self.robots if str(r["id"]) == which), None)
        if robot is None:
            return None
        if what == "robot":
            return {"id": robot["id"], "origin": robot["origin"],
                    "program": PROGRAMS[robot["program"]]["name"],
                    "phase": ["run", "tumble", "run"][robot["program"]],
                    "x_cm": round(robot["x"], 1), "y_cm": round(robot["y"], 1),
                    "theta_deg": round(math.degrees(robot["a"]) % 360, 1), "sigma_cm": 0.03,
                    "sigma_theta_deg": 0.57, "confidence": 0.9, "seen_age_s": 0.0, "age_s": 0.0,
                    "owner": "sim_svc", "band": 0, "program_age_s": 61.2, "program_epoch": 4,
                    "program_left_cm_s": 3.0, "program_right_cm_s": 3.0, "reversals": 10,
                    "reversal_age_s": 3.4, "tumbles": 43, "run_time_s": 16.3, "link_sent": 470,
                    "link_received": 4698, "link_errors": 0, "command_seq": 1, "stop_seq": 0,
                    "wheel_left_cm_s": 3.1, "wheel_right_cm_s": 2.8, "light_front": 0.42,
                    "light_back": 0.40,
                    "ir": [0, 12, 0, 0, 300, 0], "battery_V": 7.4, "flags": robot["flags"],
                    "uid": None}
        if what == "speeds":
            return {"t_s": [0.2 * i for i in range(300)],
                    "speed_cm_s": [SPEED[robot["program"]] + 0.3 * math.sin(0.3 * i)
                                   for i in range(300)]}
        if what == "analysis":
            return [self.pool(robot["program"], robot["id"])]
        return None

    def take_request(self, body):
        kind = body["request"]
        if self.replay and kind not in ("seek", "speed", "pause", "resume"):
            return "refused: a recorded run: nobody obeys"
        if kind == "stop":
            self.latched, self.stopped_at = True, self.life
            self.stop_state.update(state="stopping", by="dashboard", reason=body.get("reason"),
                                   took_ms=None,
                                   confirmed=0, unconfirmed=[r["id"] for r in self.robots])
        elif kind == "release_stop":
            self.latched = False
            self.stop_state.update(state="free", confirmed=len(self.robots), unconfirmed=[],
                                   took_ms=None)
        elif kind in ("pause", "resume"):
            self.paused = kind == "pause"
        elif kind == "mark":
            self.marks.append({"t_us": self.start_us + int(self.life * 1e6),
                               "text": "dashboard: " + body["text"]})
        elif kind == "end":
            self.end = {"t_us": self.start_us + int(self.life * 1e6), "text": "ended by dashboard"}
        elif kind == "light":
            self.manual = float(body["intensity"])
        elif kind == "release_light":
            self.manual = None
        elif kind == "seek":
            self.life, self.jumps = float(body["to_s"]), self.jumps + 1
        elif kind == "speed":
            self.speed = float(body["speed"])
        else:
            return "refused: no such request"
        return "done"
