# Sourced by the commands of this folder: finds the Python interpreter and runs one module behind it.
# /usr/bin/python3 comes first because the distribution's numpy and matplotlib belong to it; a python3 found
# earlier in PATH may have neither. REFLUX_PYTHON names another interpreter.
tools=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)

reflux_python() {
    if [ -n "${REFLUX_PYTHON:-}" ]; then
        command -v "$REFLUX_PYTHON" > /dev/null 2>&1 || {
            echo "$(basename -- "$0"): REFLUX_PYTHON=$REFLUX_PYTHON is not a program that can be run" >&2
            exit 2
        }
        echo "$REFLUX_PYTHON"
    elif [ -x /usr/bin/python3 ]; then
        echo /usr/bin/python3
    elif command -v python3 > /dev/null 2>&1; then
        command -v python3
    else
        echo "$(basename -- "$0"): python3 is missing; tools/bootstrap installs it" >&2
        exit 1
    fi
}

# Called first by the two tools that set up everything, with their arguments: without Python none can be judged.
set_up_python() {
    case " $* " in *" -h "* | *" --help "*) return ;; esac
    [ -n "${REFLUX_PYTHON:-}" ] || [ -x /usr/bin/python3 ] || command -v python3 > /dev/null 2>&1 || "$tools/bootstrap" --set-up python
}

# run_tool NAME ARGUMENTS...: does not return.
run_tool() {
    python=$(reflux_python) || exit $?
    export PYTHONPATH="$tools" PYTHONDONTWRITEBYTECODE=1
    exec "$python" -m reflux "$@"
}
