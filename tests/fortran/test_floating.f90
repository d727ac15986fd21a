!> Bodies that only contact holds: exact where it holds them, named with their motion where not.
program test_floating
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code
   use lopin_report, only : summary_type, frame_type
   use check, only : test, close_to, is_true, equal_text, finish
   use contact_scenes, only : box, run_text
   implicit none

   character(len=1), parameter :: nl = achar(10)
   character(len=9), parameter :: path(2) = [character(len=9) :: 'CONDENSED', 'NEWTON']
   character(len=20), parameter :: method(4) = [character(len=20) :: 'DIRECT', 'PENALTY', &
      & 'PERTURBED LAGRANGE', 'AUGMENTED LAGRANGE']
   character(len=*), parameter :: steel = '*MATERIAL, NAME=STEEL'//nl//'*ELASTIC'//nl &
      & //'200000., 0.3'//nl//'*SOLID SECTION, ELSET=UP, MATERIAL=STEEL'//nl
   !> A plane below; a plane above that its reference node moves.
   character(len=*), parameter :: floor_2d = '*NODE'//nl//'800000, 0., -1.'//nl &
      & //'*SURFACE, NAME=FLOOR, TYPE=SEGMENTS'//nl//'START, -30., 0.'//nl//'LINE, 30., 0.'//nl &
      & //'*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=800000'//nl
   character(len=*), parameter :: press_2d = '*NODE'//nl//'900000, 0., 6.'//nl &
      & //'*SURFACE, NAME=PRESS, TYPE=SEGMENTS'//nl//'START, 30., 4.'//nl//'LINE, -30., 4.'//nl &
      & //'*RIGID BODY, ANALYTICAL SURFACE=PRESS, REF NODE=900000'//nl
   character(len=*), parameter :: floor_3d = '*NODE'//nl//'800000, 0., 0., -1.'//nl &
      & //'*SURFACE, NAME=FLOOR, TYPE=CYLINDER'//nl//'0., 0., 0., 1., 0., 0.'//nl//'0., -1., 0.' &
      & //nl//'START, -30., 0.'//nl//'LINE, 30., 0.'//nl &
      & //'*RIGID BODY, ANALYTICAL SURFACE=FLOOR, REF NODE=800000'//nl
   integer :: p, m

   do p = 1, size(path)
      do m = 1, size(method)
         call a_cylinder_under_a_press(trim(path(p)), trim(method(m)))
         call a_block_on_a_plane(trim(path(p)), trim(method(m)))
      end do
      call two_forces_share_the_floor(trim(path(p)))
      call not_held('is lifted off', trim(path(p)), 'UPX0, 1'//nl, 'UPTOP, 2, 10.', 'move along y')
      call not_held('slides along the plane', trim(path(p)), '', 'UPTOP, 2, -10.', 'move along x')
      call not_held('is pushed along the plane', trim(path(p)), '', 'UPTOP, 1, 10.', 'move along x')
   end do
   call finish()

contains

   function pair(behaviour, pairs) result(text)
      character(len=*), intent(in) :: behaviour, pairs
      character(len=:), allocatable :: text
      text = '*SURFACE INTERACTION, NAME=TOUCH'//nl//'*SURFACE BEHAVIOR, '//behaviour//nl &
         & //'*CONTACT PAIR, INTERACTION=TOUCH'//nl//pairs
   end function pair

   subroutine a_cylinder_under_a_press(path, behaviour)
      character(len=*), intent(in) :: path, behaviour
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error

      call test('a cylinder between plates, held by symmetry alone: '//path//', '//behaviour)
      call run_text('*LOPIN, PATH='//path//nl &
         & //box('UP', 0, [0.0_wp, 0.0_wp], [8.0_wp, 4.0_wp], [8, 4], 20.0_wp)//steel//floor_2d &
         & //press_2d//'*SURFACE, NAME=TOP'//nl//'UPTOPE, S3'//nl &
         & //pair(behaviour, 'UPF, FLOOR'//nl//'TOP, PRESS'//nl)//'*BOUNDARY'//nl//'UPX0, 1'//nl &
         & //'800000, 1, 2'//nl//'800000, 6'//nl//'900000, 1'//nl//'900000, 6'//nl//'*STEP'//nl &
         & //'*STATIC'//nl//'*CLOAD'//nl//'900000, 2, -3000.'//nl//'*END STEP'//nl, frame, &
         & summary, error)
      if (failed(error)) return
      call judge(frame, 3000.0_wp, 2)
      call close_to('the press carries its load', sum(frame%contact(2)%force(2, :)), -3000.0_wp, &
         & 1.0e-9_wp)
   end subroutine a_cylinder_under_a_press

   subroutine a_block_on_a_plane(path, behaviour)
      character(len=*), intent(in) :: path, behaviour
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error

      call test('a crowned block on a plane, held by symmetry alone: '//path//', '//behaviour)
      call run_text('*LOPIN, PATH='//path//nl &
         & //box('UP', 0, 0.0_wp*[1, 1, 1], 1.0_wp*[3, 3, 2], [4, 4, 2], 20.0_wp)//steel//floor_3d &
         & //pair(behaviour, 'UPF, FLOOR'//nl)//'*BOUNDARY'//nl//'UPX0, 1'//nl//'UPY0, 2'//nl &
         & //'800000, 1, 6'//nl//'*STEP'//nl//'*STATIC'//nl//'*DLOAD'//nl//'UPTOPE, P2, 500.'//nl &
         & //'*END STEP'//nl, frame, summary, error)
      if (failed(error)) return
      call judge(frame, 4500.0_wp, 3)
   end subroutine a_block_on_a_plane

   !> The floor's force, the support's reaction, and no force on artificial supports.
   subroutine judge(frame, load, up)
      type(frame_type), intent(in) :: frame
      real(wp), intent(in) :: load
      integer, intent(in) :: up
      call close_to('the floor carries the load', sum(frame%contact(1)%force(up, :)), load, &
         & 1.0e-9_wp)
      call is_true('artificial supports carry nothing', frame%certificate%support < 1.0e-10_wp)
      call is_true('equilibrium', frame%certificate%equilibrium < 1.0e-10_wp)
      call is_true('something is open', any(frame%contact(1)%status == 0))
      call is_true('nothing pulls', all(frame%contact(1)%pressure >= 0.0_wp))
   end subroutine judge

   !> A flat block, free to turn, under two different forces: the pressure moves towards the larger.
   subroutine two_forces_share_the_floor(path)
      character(len=*), intent(in) :: path
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error
      real(wp) :: moment
      integer :: i

      call test('a block that only a plane keeps from turning: '//path)
      call run_text('*LOPIN, PATH='//path//nl &
         & //box('UP', 0, [0.0_wp, 0.0_wp], [8.0_wp, 4.0_wp], [4, 2], 1.0e9_wp)//steel//floor_2d &
         & //pair('DIRECT', 'UPF, FLOOR'//nl)//'*BOUNDARY'//nl//'6, 1'//nl//'800000, 1, 2'//nl &
         & //'800000, 6'//nl//'*STEP'//nl//'*STATIC'//nl//'*CLOAD'//nl//'11, 2, -100.'//nl &
         & //'15, 2, -300.'//nl//'*END STEP'//nl, frame, summary, error)
      if (failed(error)) return
      moment = 0.0_wp
      do i = 1, size(frame%contact(1)%node)
         moment = moment + 2.0_wp*(frame%contact(1)%node(i) - 1)*frame%contact(1)%force(2, i)
      end do
      call close_to('force', sum(frame%contact(1)%force(2, :)), 400.0_wp, 1.0e-9_wp)
      call close_to('moment about the corner', moment, 2400.0_wp, 1.0e-9_wp)
      call is_true('artificial supports carry nothing', frame%certificate%support < 1.0e-10_wp)
   end subroutine two_forces_share_the_floor

   !> A block on a floor that is not held: the error names body and motion.
   subroutine not_held(what, path, hold, load, motion)
      character(len=*), intent(in) :: what, path, hold, load, motion
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error

      call test('a body that '//what//' is named: '//path)
      call run_text('*LOPIN, PATH='//path//nl &
         & //box('UP', 0, [0.0_wp, 0.0_wp], [8.0_wp, 4.0_wp], [4, 2], 1.0e9_wp)//steel//floor_2d &
         & //pair('DIRECT', 'UPF, FLOOR'//nl)//'*BOUNDARY'//nl//hold//'800000, 1, 2'//nl &
         & //'800000, 6'//nl//'*STEP'//nl//'*STATIC'//nl//'*CLOAD'//nl//load//nl//'*END STEP'//nl, &
         & frame, summary, error)
      call is_true('an error', allocated(error))
      if (.not. allocated(error)) return
      call is_true('exit code 4', error%code == error_code%singular .and. summary%exit_code == 4)
      call equal_text('code', error%item(1)%id, 'E0310')
      call is_true('body: '//error%item(1)%message, index(error%item(1)%message, 'body UP ') > 0)
      call is_true('motion: '//error%item(1)%message, index(error%item(1)%message, motion) > 0)
   end subroutine not_held

   logical function failed(error)
      type(error_type), allocatable, intent(in) :: error
      failed = allocated(error)
      if (failed) print '(a)', error%text()
      call is_true('no error', .not. failed)
   end function failed
end program test_floating
