# Completion of lanternfishd for bash, printed by `lanternfishd completion bash`: do not edit.
_lanternfishd() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options= i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      --config|--socket) ((++i)) ;;
      status|estop|start|home|hold|resume|abort|reset|restart-bus|jog|task|commission|doctor|help|completion) command=${COMP_WORDS[i]}; break ;;
    esac
  done
  case $command in
    '')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'status')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'estop')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'start')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'home')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'hold')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'resume')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'abort')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'reset')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'restart-bus')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'jog')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(printf "%s\n" slew shoulder elbow roll jaw)" -- "$word")); return; }
      ;;
    'task')
      case $before in
        --turn) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --press) COMPREPLY=($(compgen -W "$(printf "%s\n" left centre right)" -- "$word")); return ;;
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --turn --press --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'commission')
      case $before in
        --joint) COMPREPLY=($(compgen -W "$(printf "%s\n" slew shoulder elbow roll jaw)" -- "$word")); return ;;
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --joint --here --clear --moved --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'doctor')
      case $before in
        --interface) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --interface --machine --bus --config --socket --check --print-config --print-schema --run --json --version'
      ;;
    'help')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(printf "%s\n" status estop start home hold resume abort reset restart-bus jog task commission doctor help completion)" -- "$word")); return; }
      ;;
    'completion')
      case $before in
        --config) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --socket) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --config --socket --check --print-config --print-schema --run --json --version'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(printf '%s\n' bash zsh)" -- "$word")); return; }
      ;;
  esac
  [ -n "$command" ] || options+=' status estop start home hold resume abort reset restart-bus jog task commission doctor help completion'
  COMPREPLY=($(compgen -W "$options" -- "$word"))
}
complete -F _lanternfishd lanternfishd
