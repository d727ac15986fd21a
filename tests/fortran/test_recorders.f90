!> Recorders on a made-up scene. With arguments it writes files for the tests in Python:
!> `write FOLDER WORD` (a job), `loop FOLDER` (until it is killed), `time FOLDER` (50 000 bricks).
program test_recorders
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type
   use lopin_model, only : model_type, output_of
   use lopin_report, only : frame_type, summary_type
   use lopin_recorder, only : recorder_holder_type, wants_type
   use lopin_atomic_file, only : file_exists, read_text, write_atomically, make_folder
   use lopin_text_buffer, only : text_buffer_type
   use lopin_recorder_memory, only : memory_recorder_type
   use lopin_recorder_factory, only : new_recorders, append_memory
   use lopin_recorder_table, only : pair_name
   use recorder_scene, only : make_scene, make_frame, make_summary, make_bricks, add_output
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none
   character(len=*), parameter :: words(13) = [character(len=6) :: 'CPE3', 'CPE4', 'CPE6', &
      & 'CPE8', 'CPS4', &
      & 'CAX4', 'CAX8', 'C3D4', 'C3D6', 'C3D8', 'C3D10', 'C3D15', 'C3D20']
   character(len=256) :: mode, folder, word
   integer :: i

   call get_command_argument(1, mode)
   call get_command_argument(2, folder)
   call get_command_argument(3, word)
   select case (mode)
   case ('write')
      call write_job(trim(folder), trim(word))
   case ('loop')
      call write_for_ever(trim(folder))
   case ('time')
      call time_bricks(trim(folder))
   case default
      call numbers_are_written_as_fortran_does()
      do i = 1, size(words)
         call write_job('recorders/'//trim(words(i)), trim(words(i)))
         call a_job_leaves_the_files_it_lists('recorders/'//trim(words(i)), trim(words(i)))
      end do
      call memory_gives_back_what_it_was_told()
      call only_what_is_asked_is_wanted()
      call a_second_run_replaces_the_first()
      call foreign_files_are_refused()
      call finish()
   end select

contains

   subroutine numbers_are_written_as_fortran_does()
      real(wp), parameter :: list(9) = [0.0_wp, 1.0_wp, -1.0_wp, 9.9999996_wp, 123456.789_wp, &
         & -1.0e-7_wp, &
         & 9.99999951e99_wp, 2.5e-98_wp, 1.0e120_wp]
      type(text_buffer_type) :: text
      character(len=13) :: expected
      integer :: i

      call test('a number is written as by 1P,E13.6, an integer as by I10')
      do i = 1, size(list)
         call text%clear()
         call text%put_exponential(list(i), 6)
         write (expected, '(1p,e13.6)') list(i)
         call equal_text('real', text%content(), expected)
      end do
      call text%clear()
      call text%put_integer(-2147483647, 3)
      call text%put_integer(42, 10)
      call equal_text('integers', text%content(), '-2147483647        42')
   end subroutine numbers_are_written_as_fortran_does

   subroutine ask_for_everything(model)
      type(model_type), intent(inout) :: model

      call add_output(model, output_of%node_print, ['U ', 'RF'], set=1)
      call add_output(model, output_of%node_print, ['RF'], set=2, totals=.true.)
      call add_output(model, output_of%node_print, ['RF'], set=2, totals_only=.true., frequency=2)
      call add_output(model, output_of%element_print, ['S   ', 'E   ', 'EVOL', 'ELSE'], set=1, &
         & totals=.true.)
      call add_output(model, output_of%contact_print, ['CDIS', 'CSTR', 'CNUM', 'CF  '])
      call add_output(model, output_of%node_file, ['U ', 'RF'])
      call add_output(model, output_of%element_file, ['S', 'E'])
      call add_output(model, output_of%contact_file, ['CDIS', 'CSTR'])
   end subroutine ask_for_everything

   !> Two increments of a job called `job`.
   subroutine write_job(folder, word)
      character(len=*), intent(in) :: folder, word
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error

      call make_scene(model, word)
      call ask_for_everything(model)
      call new_recorders(list, model, folder, 'job', error, deck_file=['deck.inp'])
      call must_succeed(error)
      call run(list, model, 2)
   end subroutine write_job

   subroutine run(list, model, last)
      type(recorder_holder_type), intent(inout) :: list(:)
      type(model_type), intent(in) :: model
      integer, intent(in) :: last
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error, failure
      integer :: i, k

      do k = 1, size(list)
         call list(k)%recorder%begin(model, error)
         call must_succeed(error)
         call list(k)%recorder%commit(error)
         call must_succeed(error)
         call list(k)%recorder%line('begun')
      end do
      do i = 1, last
         call make_frame(frame, model, i, last)
         do k = 1, size(list)
            call list(k)%recorder%increment(model, frame, error)
            call must_succeed(error)
         end do
      end do
      call make_summary(summary)
      do k = 1, size(list)
         call list(k)%recorder%close(error)
         call must_succeed(error)
         call list(k)%recorder%finish(model, summary, failure, error)
         call must_succeed(error)
      end do
   end subroutine run

   subroutine must_succeed(error)
      type(error_type), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      call test('no error')
      call equal_text('error', error%text(), '')
   end subroutine must_succeed

   subroutine a_job_leaves_the_files_it_lists(folder, word)
      character(len=*), intent(in) :: folder, word
      character(len=*), parameter :: files(9) = [character(len=30) :: 'job.json', 'job.pvd', &
         & 'job_0001.vtu', &
         & 'job_contact_TOP-DIE_0002.vtu', 'job_tool_BALL_0002.vtu', 'job.dat', 'job.frd', &
         & 'job.sta', &
         & 'job_history.csv']
      integer :: i

      call test('a job of '//word//' leaves its files and no temporary one')
      do i = 1, size(files)
         call is_true(trim(files(i)), file_exists(folder//'/'//trim(files(i))))
         call is_true('no part', .not. file_exists(folder//'/'//trim(files(i))//'.part'))
      end do
   end subroutine a_job_leaves_the_files_it_lists

   subroutine memory_gives_back_what_it_was_told()
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(frame_type) :: frame
      real(wp), allocatable :: values(:, :)
      integer, allocatable :: counts(:, :)
      character(len=:), allocatable :: pair

      call test('memory gives back by name what it was told, beyond its first room')
      call make_scene(model, 'CAX4')
      call append_memory(list)
      call run(list, model, 20)
      call make_frame(frame, model, 20, 20)
      select type (memory => list(1)%recorder)
      type is (memory_recorder_type)
         call is_true('20 frames', memory%nframe == 20)
         pair = pair_name(model, 2)
         call memory%get_real('U', 20, values)
         call close_to('u', values, frame%u(:2, :), 0.0_wp)
         call memory%get_real('S', 20, values)
         call close_to('stress', values, frame%nodal_stress, 0.0_wp)
         call memory%get_real(pair//':CPRESS', 20, values)
         call close_to('pressure', values(1, :), frame%contact(2)%pressure, 0.0_wp)
         call memory%get_integer(pair//':LABEL', 3, counts)
         call is_true('nodes', all(counts(1, :) == model%mesh%node_label(frame%contact(2)%node)))
         call memory%get_real('history.increment', 0, values)
         call is_true('increments', size(values) == 20 .and. nint(values(1, 20)) == 20)
         call memory%get_real('TIME', 0, values)
         call close_to('time', values(1, 10), 0.5_wp, 1.0e-12_wp)
         call memory%get_integer('MESH.quad', 0, counts)
         call is_true('cells', size(counts, 1) == 4 .and. all(counts > 0))
         call is_true('names', index(memory%names(), pair//':CPRESS') > 0)
         call is_true('summary', index(memory%json%content, '"status": "finished"') > 0)
         call memory%get_real('NO-PAIR:CPRESS', 1, values)
         call is_true('no such pair', .not. allocated(values))
         call memory%get_real('nonsense', 1, values)
         call is_true('no nonsense', .not. allocated(values))
      end select
   end subroutine memory_gives_back_what_it_was_told

   subroutine only_what_is_asked_is_wanted()
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error
      type(wants_type) :: wants
      type(frame_type) :: now

      now%step = 1
      now%increment = 1
      call test('stress is wanted unless *OUTPUT, FIELD leaves it out; tables if asked')
      call make_scene(model, 'C3D8')
      call new_recorders(list, model, 'recorders/few', 'job', error)
      call must_succeed(error)
      call is_true('4 recorders', size(list) == 4)
      wants = list(2)%recorder%wants(model, now)
      call is_true('nodal stress', wants%nodal_stress .and. .not. wants%strain)
      call add_output(model, output_of%field, ['U'], frequency=2)
      call new_recorders(list, model, 'recorders/few', 'job', error)
      wants = list(2)%recorder%wants(model, now)
      call is_true('no stress', .not. wants%nodal_stress)
      call run(list, model, 5)
      call is_true('increments 2, 4 and the last', file_exists('recorders/few/job_0003.vtu'))
      call is_true('no more', .not. file_exists('recorders/few/job_0004.vtu'))
   end subroutine only_what_is_asked_is_wanted

   subroutine a_second_run_replaces_the_first()
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error
      character(len=*), parameter :: folder = 'recorders/twice'

      call test('a second run replaces the first and removes the outputs that it no longer has')
      call make_scene(model, 'CPE4')
      call new_recorders(list, model, folder, 'job', error)
      call must_succeed(error)
      call run(list, model, 3)
      call write_atomically(folder//'/job_0009.vtu', 'mine', error)
      call new_recorders(list, model, folder, 'job', error)
      call must_succeed(error)
      call run(list, model, 1)
      call is_true('first', file_exists(folder//'/job_0001.vtu'))
      call is_true('no third', .not. file_exists(folder//'/job_0003.vtu'))
      call is_true('not ours', file_exists(folder//'/job_0009.vtu'))
   end subroutine a_second_run_replaces_the_first

   subroutine foreign_files_are_refused()
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error
      character(len=*), parameter :: folder = 'recorders/foreign'
      character(len=:), allocatable :: text

      call test('a file that Lopin did not write is refused and stays')
      call make_scene(model, 'CPE4')
      call make_folder(folder, error)
      call write_atomically(folder//'/job.sta', 'mine', error)
      call new_recorders(list, model, folder, 'job', error)
      call is_true('refused', allocated(error))
      if (allocated(error)) call is_true('names it', index(error%text(), 'job.sta') > 0)
      call read_text(folder//'/job.sta', text)
      call equal_text('text', text, 'mine')
   end subroutine foreign_files_are_refused

   subroutine write_for_ever(folder)
      character(len=*), intent(in) :: folder
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error

      call make_scene(model, 'C3D20')
      call ask_for_everything(model)
      call new_recorders(list, model, folder, 'job', error)
      call run(list, model, 1000000)
   end subroutine write_for_ever

   subroutine time_bricks(folder)
      character(len=*), intent(in) :: folder
      type(model_type) :: model
      type(frame_type) :: frame
      type(recorder_holder_type), allocatable :: list(:)
      type(error_type), allocatable :: error
      integer(int64) :: start, end, rate
      integer :: k, i

      call make_bricks(model, 37)
      call add_output(model, output_of%node_file, ['U'])
      call add_output(model, output_of%element_file, ['S'])
      call new_recorders(list, model, folder, 'job', error)
      call must_succeed(error)
      call make_frame(frame, model, 1, 2)
      do k = 2, size(list), size(list) - 2
         do i = 1, 3
            call system_clock(start, rate)
            if (i == 1) call list(k)%recorder%begin(model, error)
            if (i > 1) call list(k)%recorder%increment(model, frame, error)
            call system_clock(end)
            print '(a)', merge('vtu ', 'frd ', k == 2)//to_text(real(end - start, wp) &
               & /real(rate, wp), 3)//' s'
         end do
      end do
   end subroutine time_bricks
end program test_recorders
