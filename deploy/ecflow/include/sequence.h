# Runs thunderhead sequence with the suite's flags and with "$@".
name='%NAME%'
code=0
# The program runs in the background, so that the shell handles a signal while it draws. FLAGS has several words.
# shellcheck disable=SC2086
%THUNDERHEAD% sequence '%STORM%' --product "%PRODUCTS%/${name//@/%%}.png" --progress ecflow %FLAGS% "$@" &
program=$!
wait "$program" || code=$?
program=
case "$code" in
  0) ;;
  # An operator must act, so ecFlow must not try again, even if some of ECF_TRIES are left.
  64 | 65 | 78)
    ecflow_client --alter=set_flag force_aborted "$ECF_NAME"
    aborted "thunderhead ended with $code, which another try does not help"
    ;;
  *) aborted "thunderhead ended with $code" ;;
esac
