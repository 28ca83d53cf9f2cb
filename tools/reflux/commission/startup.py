"""One start-up, from the questions to the loops that are kept, or to the reason why there are none."""

from __future__ import annotations

import contextlib
import signal
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Iterator

from reflux import scenario_settings, session, table
from reflux.commission import answers_board, answers_file, dialogue, next_steps, results, results_text
from reflux.commission.answers import TEST, Answers, Room
from reflux.commission.board import UNDER_WAY, Board, Event, Plant, Progress
from reflux.commission.dialogue import heading, say
from reflux.commission.keyboard import KEYS, Keyboard
from reflux.commission.progress import follow
from reflux.errors import RunFailed, UserError
from reflux.paths import shown, tool
from reflux.session import Refused

GREETING_S = 5.0
SAY_S = 3.0
ABORT_MOST_S = 130.0  # for a sample that brings what is then aborted
PATIENCE_TICKS = 8  # for readings to be valid, once configured
LISTINGS = ("model", "gains", "pairing", "structure", "proposal")


@dataclass
class Options:
    file: Path | None
    yes: bool
    write_file: Path | None
    out: Path
    simulated: bool = False  # the board ends with the tool
    conf: Path | None = None  # what the simulated board has before

    @property
    def unattended(self) -> bool:
        return self.yes or self.file is not None


@dataclass
class Startup:
    board: Board
    options: Options
    operating: dict[str, float]    # of a simulated plant
    alive: Callable[[], None]      # raises where the plant's process has ended
    keyboard: Keyboard | None = None
    begun: bool = False
    pending: bool = False  # asked for, and not there before the plant's next sample
    tick_s: float = 1.0
    why: str = ""

    left: list[str] = field(default_factory=list)  # what was tested and has no loop, in words

    def run(self) -> None:
        """Returns where the loops are kept; RunFailed says why they are not. left: what has none all the same."""
        plant = self.meet()
        answers = self.answers(plant)
        self.note_settings()
        with self.watched():
            ended = self.test(answers)
        if ended.phase != "ready":
            self.show_advice()
            raise RunFailed(f"the start-up ended: {self.why}; no loop has changed; the settings for the tests stay in force")
        self.show_results(answers)
        with self.watched():
            try:
                self.decide(answers)
            except BaseException:
                self.abandon()
                raise
            self.trial(answers)
        self.leave()

    def note_end(self) -> None:
        """For the report, whatever the end was."""
        if self.begun:
            for command in ("commission", "commission model", "commission trial"):
                self.board.ask(command)

    # ---- before ----

    def meet(self) -> Plant:
        plant = self.board.plant(GREETING_S)
        self.tick_s = plant.tick_s
        if not plant.measurements or not plant.inputs:
            raise RunFailed(f"{plant.name} announces no {'input' if plant.measurements else 'measurement'}")
        state = self.board.state()
        if state.locked:
            raise UserError("the board's engineer level is locked; --key KEY opens it")
        if state.open_transaction:
            raise RunFailed(f"somebody's transaction is open on the board: `apply` or `abandon` it first ({tool('console')})")
        if self.board.progress().phase in UNDER_WAY:
            raise RunFailed(f"a start-up is under way on the board already; `commission abort` ends it ({tool('console')})")
        heading(f"{plant.name}: {len(plant.measurements)} measurements, {len(plant.inputs)} inputs, a sample every "
                f"{plant.tick_s:g} s")
        say(dialogue.plant_lines(plant, state))
        return plant

    def answers(self, plant: Plant) -> Answers:
        """Asked for, or read; in force on the board, and its plant sent to the operating point."""
        board = self.board
        parameters = board.parameters()
        room = Room(board.channels(), board.count("pair", "meas"),
                    {f.name: board.allowed(f.parameter) for f in TEST if not f.words})
        answers = answers_board.defaults(plant, parameters, board.state(), self.operating, room)
        if self.options.file:
            answers_file.read(self.options.file, answers)
        elif self.options.yes and (missing := answers.missing()):
            raise UserError(f"{missing} (in a file, with --file)")
        while True:
            if self.keyboard and not self.options.unattended:
                dialogue.ask_all(self.keyboard, answers)
            else:
                heading("Answers")
                say(dialogue.summary(answers))
            self.keep(answers)
            heading("What it will do to the plant")
            for line in dialogue.expectations(answers):
                say(line)
            if self.keyboard and not self.options.unattended and not dialogue.may_begin(self.keyboard):
                raise RunFailed("not begun: nothing has moved")
            try:
                self.configure(answers_board.set_lines(answers, parameters, room.channels), answers, parameters)
                return answers
            except Refused as error:
                if self.options.unattended:
                    raise UserError(f"the board refuses: {error}") from None
                say(f"\nThe board refuses: {error}. Once more:")

    def keep(self, answers: Answers) -> None:
        text = answers_file.text(answers)
        for path in (self.options.out / "answers.toml", self.options.write_file):
            try:
                if path:
                    path.write_text(text, encoding="utf-8")
            except OSError as error:
                raise UserError(f"{path} cannot be written: {error.strerror}") from None

    def configure(self, lines: list[str], answers: Answers, parameters: dict[str, str]) -> None:
        """All or nothing; and at once to the operating point, for a plan that has just come leaves the outputs of a safe
        state where they are safe."""
        moves = self.moves(answers)
        self.board.new_events()
        if lines:
            self.board.ask("begin")
            try:
                for line in lines:
                    self.board.ask(line)
            except BaseException:
                self.abandon()
                raise
        refusals = self.board.ask_together([*(["apply"] if lines else []),
                                            *(f"out {name} {at:.9g}" for name, at in moves.items())])
        if refusals:
            self.abandon()
            raise Refused(refusals[0])
        say(f"\n{len(lines)} parameters set; nothing of it is stored, `save` would do that ({tool('console')})." if lines else
            "\nThe board is configured so already.")
        for name, at in moves.items():
            say(f"{name} goes to {at:g} {answers.channel(name).channel.unit}")
        if lines:
            self.await_event("CONFIG_APPLIED", "CONFIG_REFUSED")
        # A move of an output that a loop drives is reported under the name of that loop.
        drives = {loop: parameters.get(f"{k}.out") for loop, k in scenario_settings.in_use(parameters, "loop").items()}
        for name in moves:
            self.await_event("OUTPUT", "REQUEST_REFUSED", subjects=(name, *(loop for loop, out in drives.items() if out == name)))
        self.board.new_events()

    def moves(self, answers: Answers) -> dict[str, float]:
        """Inputs that are not where the answers want them."""
        state, out = self.board.state(), {}
        for v in answers.inputs:
            at, name = v.values["at"], v.channel.name
            configured = v.place is not None or v.values["tested"]
            if at is not None and configured and (state.safe or state.values.get(name) != at):
                out[name] = at
        return out

    def note_settings(self) -> None:
        """For the report, which is made from the transcript alone."""
        for command in ("version", "list", "log on"):
            self.board.ask(command)

    # ---- tests ----

    def test(self, answers: Answers) -> Progress:
        heading("Tests")
        self.begin()
        until = ("ready", "ended", "idle")
        p = follow(self.board, answers, self.keyboard, self.alive, until, tuple(KEYS.values()))
        if p.phase != "ready":
            self.why = p.text.removeprefix("- ") or p.phase
        return p

    def begin(self) -> None:
        """Readings of channels that have just been configured are valid a sample later."""
        board, began, said, freed = self.board, time.monotonic(), False, False
        until_s = board.state().plant_s + PATIENCE_TICKS * self.tick_s
        board.new_events()
        while True:
            try:
                self.pending = True
                board.ask("commission begin")
                break
            except Refused as error:
                self.pending = False
                refusal = str(error)
            passing = "is not valid" in refusal or "safe state" in refusal or (freed and "workspace" in refusal)
            if not passing and self.options.conf and "workspace" in refusal and self.free_workspace():
                freed = True
                until_s = board.state().plant_s + PATIENCE_TICKS * self.tick_s
                board.listen(0.2)  # the board does it at its next sample
                continue
            if not passing or board.state().plant_s > until_s:
                raise RunFailed(f"the board will not begin: {refusal}")
            if not said and time.monotonic() - began > SAY_S:
                said = True
                say(f"waiting: {refusal.removeprefix('err ')}")
            board.listen(0.2)
            self.alive()
        self.await_event("COMMISSION_BEGUN", "REQUEST_REFUSED")
        self.begun, self.pending = True, False

    def free_workspace(self) -> bool:
        """Takes the workspace from estimators of --conf, which go on without it; false where there are none."""
        blocks = [name.removesuffix(".kind").removeprefix("block") for name, value in self.board.parameters().items()
                  if name.startswith("block") and name.endswith(".kind") and value == "composition"]
        for number in blocks:
            with contextlib.suppress(Refused):
                self.board.ask(f"block {number} free")
                say(f"block {number} gives its workspace to the start-up (`block {number} free`): its estimates are uncertain from here on")
        return bool(blocks)

    def await_event(self, wanted: str, refused: str, subjects: tuple[str, ...] = ()) -> Event:
        """Comes with the plant's next sample."""
        while True:
            for event in list(self.board.events):
                if subjects and event.subject not in subjects:
                    continue
                if event.code == refused:
                    raise RunFailed(f"the board refused it at its next sample: {event.subject} {event.text}")
                if event.code == wanted:
                    return event
            self.board.listen(0.2)
            self.alive()

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        """However this program ends meanwhile, the tests or the trial end before it."""
        try:
            yield
        except BaseException:
            self.abort()
            raise

    def abort(self) -> None:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            end = time.monotonic() + min(2 * self.tick_s + 1, ABORT_MOST_S)
            while self.board.progress().phase not in UNDER_WAY:
                if not self.pending or time.monotonic() > end:
                    return
                self.board.listen(0.2)
            self.board.ask("commission abort")
            say("\naborted on the board (`commission abort`)")
            for _ in range(20):
                p = self.board.progress()
                if p.phase not in UNDER_WAY:
                    say("the inputs are back where they were held" if p.phase == "ended" else
                        "the loops are in manual, the outputs back where they were held, the old settings return")
                    return
                self.board.listen(0.2)
            say("it ends with the plant's next sample")
        except (RunFailed, OSError) as error:
            say(f"\nthe board could not be told to abort ({error}): `commission abort` at its console, or the plant's own "
                "means")
        finally:
            signal.signal(signal.SIGINT, before)

    # ---- results ----

    def show_results(self, answers: Answers) -> None:
        said = {name: self.board.ask(f"commission {name}") for name in LISTINGS}
        model, gains = results.model_of(said["model"]), results.gains_of(said["gains"])
        pairing, proposal = results.pairing_of(said["pairing"]), results.proposal_of(said["proposal"])
        heading("Model")
        say(table.columns(*results_text.model_rows(model)))
        if model.direction:
            say("\n" + results_text.direction_words(model))
            say(table.columns(*results_text.direction_rows(model)))
        heading("Gains")
        for words in results_text.gains_words(gains):
            say(words)
        if gains.rga:
            say("\nrelative gains")
            say(table.columns(*results_text.rga_rows(gains)))
        heading("Pairing")
        if pairing.pairs:
            say(table.columns(*results_text.pairing_rows(pairing)))
        for words in (*results_text.pairing_words(pairing), *results_text.structure_words(results.structure_of(said["structure"]))):
            say(words)
        self.left = results_text.left_words(pairing)
        heading("Proposal")
        for words in results_text.proposal_words(proposal):
            say(words)
        if proposal.loops:
            spans = {v.channel.name: (v.values["hi"] - v.values["lo"], v.channel.unit) for v in (*answers.measurements, *answers.inputs)}
            say(table.columns(*results_text.loop_rows(proposal, spans)))
            say("\n" + results_text.LOOPS_NOTE)
        if not proposal.loops:
            heading("What to do next")
            self.show_advice()
            if not pairing.determined:
                for words in next_steps.lines(model, pairing, answers.known_pairs(), self.board.parameters(),
                                              self.board.count("loop", "name")):
                    say(words)
            why = proposal.why_not.removeprefix("pairing not determined: ") or "there is no proposal"
            more = "; ".join([*pairing.doubts, *self.left])
            raise RunFailed(f"not determined: {why}{f' ({more})' if more else ''}")

    def show_advice(self) -> None:
        """What the board has computed; one without this listing has none."""
        with contextlib.suppress(Refused):
            for line in self.board.ask("commission advice"):
                say(f"- At the board's console: {line}" if line.startswith("`set ") else f"- {line}")

    def decide(self, answers: Answers) -> None:
        if self.options.unattended:
            if answers.proposal == "reject":
                self.reject()
            if answers.edits:
                self.edit(answers)
            self.accept()
            return
        assert self.keyboard
        while True:
            word = dialogue.decide(self.keyboard)
            if word == "reject":
                self.reject()
            if word == "edit":
                self.edit_by_hand(answers)
                continue
            try:
                self.accept()
            except Refused as error:
                say(f"  {error}")
                continue
            answers.proposal = "accept"
            self.keep(answers)
            return

    def reject(self) -> None:
        self.board.ask("commission reject")
        raise RunFailed("the proposal was rejected: no loop has changed")

    def abandon(self) -> None:
        with contextlib.suppress(Refused):
            self.board.ask("abandon")

    def edit(self, answers: Answers) -> None:
        self.board.ask("commission edit")
        for name, value in answers.edits.items():
            try:
                self.board.ask(dialogue.check_edit(f"{name} {value}"))
            except Refused as error:
                raise UserError(f"proposal.set.{name}: {error}") from None

    def edit_by_hand(self, answers: Answers) -> None:
        assert self.keyboard
        try:
            self.board.ask("commission edit")
        except Refused as error:
            if "open already" not in str(error):
                say(f"  {error}")
                return
        say("The proposal as settings; change them, such as `loop1.gain 1.2`. An empty line ends it, `drop` takes it back.")
        say("\n".join(f"  {line}" for line in self.board.ask("diff")))
        while line := self.keyboard.ask("edit > "):
            if line == "drop":
                self.abandon()
                answers.edits.clear()
                return
            if line == "diff":
                say("\n".join(f"  {text}" for text in self.board.ask("diff")))
                continue
            try:
                command = dialogue.check_edit(line)
                self.board.ask(command)
            except (UserError, Refused) as error:
                say(f"  {error}")
                continue
            answers.edits[command.split()[1]] = command.split()[2]

    def accept(self) -> None:
        self.board.new_events()
        self.pending = True
        try:
            self.board.ask("commission accept")
        except Refused as error:
            self.pending = False
            if self.options.unattended:
                raise UserError(f"the board refuses the proposal as it was edited: {error}") from None
            raise

    # ---- trial ----

    def trial(self, answers: Answers) -> None:
        heading("Trial")
        if answers.edits:
            say("The prediction is still that of the proposed settings: a loop that was edited to be much slower misses it, and is rolled back.")
        self.await_event("TRIAL_BEGUN", "CONFIG_REFUSED")
        self.pending = False
        p = follow(self.board, answers, self.keyboard, self.alive, ("kept", "returned", "ended", "idle"), ("abort",))
        loops = results.trial_of(self.board.ask("commission trial"))
        say(table.columns(*results_text.trial_rows(loops)))
        if p.phase != "kept":
            raise RunFailed(f"the proposal was rolled back: {p.text or p.phase}; the old settings are in force")

    def leave(self) -> None:
        say()
        for line in self.board.ask("loop"):
            say(table.rounded(line))
        self.board.ask("list")
        saved = self.options.out / "board.conf"
        saved.write_text("\n".join(session.dump(self.board.session)) + "\n", encoding="latin-1")
        if self.options.simulated:
            name, conf = shown(saved), self.options.conf
            lacks = f"It holds the settings of {shown(conf)}, too." if conf else "It has no interlocks: with --conf FILE yours act here, too, and it holds them."
            say(f"\nThe simulated plant and its board end with this command. {name} holds the configuration.\n{lacks}\n"
                f"On a board with such a plant `{tool('console')} PORT --restore {name}` puts it into force, and `save` stores it.\n"
                "A restore replaces all settings of that board: it deletes the interlocks and alarms that the file does not have.")
            return
        say("\nThe loops stay in automatic. Nothing is stored: `save` at the board's console keeps the configuration over "
            f"a restart\n({tool('console')} PORT, then save); {shown(saved)} holds it too ({tool('console')} PORT --restore {shown(saved)}).")
