//! What `--help` says below the options: examples, notes, exit codes. Lines of prose are broken by the terminal's width.

/// Of the program.
pub(super) const EXAMPLES: &str = "\
Examples:
  darrt problems
      the built-in problems: the paper's, and others
  darrt plan plate3
      solve one; writes plate3.plan.json and plate3.html
  darrt show plate3.plan.json
      draw a plan again
  darrt plan plate3 --record r.json
      keep the search too; then: darrt show r.json -o tree.graphml
  darrt check plate3.plan.json
      judge a plan, for example one edited by hand
  darrt export plate3.plan.json --to json
      the plan on its clock, for a controller
  darrt execute plate3.plan.json --noise 0.5
      a hundred times in physics, with half the errors of a real robot
  darrt bench
      the paper's table: every problem, ten seeds
  darrt problems --print plate3 > mine.toml
      copy a problem, edit it, then: darrt plan mine.toml

In the place of a problem or a plan to read, - is the standard input; with `plan -o -` the plan goes to the standard output.

Exit codes:
  0    solved, or the plan is accepted
  1    not solved within the budget; a plan that is executed fails in some
       run; an idea has something wrong
  2    bad input or usage
  3    the verifier refuses the plan; with `check --strict` also a plan with
       warnings
  4    the output cannot be written, or not be opened
  5    not solved within the budget, and the beginning of a plan is written
       (PROBLEM.partial.json); with `check`: the plan is such a beginning, and
       right
  6    proven before the search: the problem, as it is written, has no plan
  130  interrupted";

/// Of `darrt plan`.
pub(super) const PLAN_EXAMPLES: &str = "\
Examples:
  darrt plan plate1
      until solved or out of time
  darrt plan plate3 --seed 7 -o p.json
      another random seed, another file
  darrt plan plate3 --iterations 20000 --restart 5000 --time-limit 3600
      limited by work, not by the clock
  darrt plan plate3 --improve steps --time-limit 30
      the plan with the fewest steps that is found in 30 s
  darrt plan mine.toml --stats
      see where the attempts end

The same problem, seed and options give the same plan file byte for byte, with any number \
of threads, as long as the time limit is not what ends the search or the improvement.

Every attempt ends at a restart; --improve and --search portfolio need them, and begin a new \
attempt after 2000 iterations if neither the problem nor --restart says when. The share of an \
attempt in --iterations is all that it may use until its restart, also when it needs less. \
After Ctrl-C, --improve gives the best plan so far: the first line says that it was interrupted, \
and the exit code is 0, because there is a plan.

--search portfolio: the first attempt is darrt, then connect, hierarchical, hierarchical-connect \
and so on, so a short --restart brings the others in. \
Every plan that is found is improved in the seconds that it takes to carry out, with a number of \
attempts that its steps decide, before it is verified; --no-improve leaves that out, and so does \
--improve clearance. --improve COST chooses among several plans. \
Travel is a bound on the ways of all points of the robot and of what it \
moves: with less of it the base alone may go farther.";

/// Of `darrt explain`.
pub(super) const EXPLAIN_NOTES: &str = "\
Plans the problem as it is, and then with changes: without an obstacle, with a smaller one, with wider limits, with \
another primitive, without a part of the goal, with more iterations; then without several obstacles, and with two \
changes. Every plan that is told was verified. All cores are used, and no clock: the same problem and seed have the \
same answer. Exit code 1: none of the changed problems has a plan.";

/// Of `darrt execute`.
pub(super) const EXECUTE_EXAMPLES: &str = "\
Examples:
  darrt execute plate3.plan.json
      once, in a world that is as the plan has it
  darrt execute plate3.plan.json --noise 1
      100 times, with the errors of a real robot
  darrt execute plate3.plan.json --noise mine.toml
      with errors of your own
  darrt execute plate3.plan.json --noise 1 --replan
      closed loop: looks, corrects, plans anew
  darrt execute plate3.plan.json --noise 1 --predict
      what to expect, without physics
  darrt execute --print-noise > mine.toml
      the errors of a real robot, to copy and edit

Without --replan the plan is executed as it is, open loop. A run succeeds if every object ends at its goal, within the \
tolerance of the problem, and nothing else was moved. The first departure from the plan is told as the \
cause of a failure. The same plan, noise and seed give the same runs with any number of threads.";

/// Of `darrt export`.
pub(super) const EXPORT_EXAMPLES: &str = "\
Examples:
  darrt export plate3.plan.json --to json
      trajectories by group: arm, base, gripper
  darrt export plate3.plan.json --to mcap
      a recording to look at in Foxglove
  darrt export old.plan.json --to plan -o new.plan.json
      a plan without a clock gets one

The plan is judged first; what is refused is not exported (exit code 3).";

/// Of `darrt bench`.
pub(super) const BENCH_EXAMPLES: &str = "\
Examples:
  darrt bench
      the paper's table, ten seeds each
  darrt bench plate3 --seeds 0..100 --variants default,euclidean --report p.html
  darrt bench --variants all --seeds 20 --shard 1/2 --out one.jsonl
      on one machine
  darrt bench --variants all --seeds 20 --shard 2/2 --out two.jsonl
      on another
  darrt bench --merge one.jsonl two.jsonl --report page.html --ompl logs

The same command after an interruption goes on where it stopped. Runs without a plan count in \
every quantile, as longer than the time they had.";

/// Of `darrt generate`.
pub(super) const GENERATE_EXAMPLES: &str = "\
Examples:
  darrt generate plate3 --seeds 7..8 > mine.toml
      one problem
  darrt generate plate3 --seeds 200 --into many
      many/plate3-g0.toml and so on
  darrt bench many --seeds 1
      how the planner does on them

The same problem and seed give the same file. Every problem is valid and was solved once.";
