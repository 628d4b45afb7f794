# Runs thunderhead sequence with "$@" besides the suite's flags.
name='%NAME%'
code=0
# In the background, so that a signal is heard while it draws. FLAGS are several words.
# shellcheck disable=SC2086
%THUNDERHEAD% sequence '%STORM%' --product "%PRODUCTS%/${name//@/%%}.png" --progress ecflow %FLAGS% "$@" &
program=$!
wait "$program" || code=$?
program=
case "$code" in
  0) ;;
  # Somebody has to look, so ecFlow is not to try again, however many ECF_TRIES are left.
  64 | 65 | 78)
    ecflow_client --alter=set_flag force_aborted "$ECF_NAME"
    aborted "thunderhead ended with $code, which another try does not help"
    ;;
  *) aborted "thunderhead ended with $code" ;;
esac
