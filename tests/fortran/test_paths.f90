!> The condensed path against the whole system factorised at every change of contact.
program test_paths
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_report, only : summary_type, frame_type
   use check, only : test, close_to, is_true, equal_text, finish
   use contact_scenes, only : scene_names, scene_text, run_text
   implicit none

   character(len=1), parameter :: nl = achar(10)
   character(len=20), parameter :: method(4) = [character(len=20) :: 'DIRECT', 'PENALTY', &
      & 'PERTURBED LAGRANGE', &
      & 'AUGMENTED LAGRANGE']
   real(wp), parameter :: digits = 1.0e-10_wp
   integer :: scene, i

   do scene = 1, size(scene_names)
      do i = 1, size(method)
         call paths_agree(trim(scene_names(scene)), ', '//trim(method(i)), '')
         if (i > 1) call paths_agree(trim(scene_names(scene)), ', '//trim(method(i))//nl//'3.e6', &
            & '')
      end do
   end do
   call paths_agree('roller', ', PRESSURE-OVERCLOSURE=EXPONENTIAL'//nl//'1.e-3, 100.', '')
   call paths_agree('indent', ', DIRECT', ', SOLVER=DENSE')
   call paths_agree('indent', ', PENALTY', ', SOLVER=DENSE')
   call paths_agree('punch', ', PENALTY', ', SOLVER=SKYLINE')
   call paths_agree('roller', ', PENALTY', ', CONTINUATION=3')
   call dependent_rows_are_named()
   call finish()

contains

   subroutine paths_agree(scene, behaviour, choices)
      character(len=*), intent(in) :: scene, behaviour
      character(len=*), intent(in) :: choices   !! more parameters of *LOPIN
      type(frame_type) :: one, two
      type(summary_type) :: first, second
      type(error_type), allocatable :: error

      call test('both paths find one answer: '//scene//behaviour//choices)
      call run_text(scene_text(scene, behaviour, '*LOPIN, PATH=CONDENSED'//choices//nl, 1), one, &
         & first, error)
      if (refused(error)) return
      call run_text(scene_text(scene, behaviour, '*LOPIN, PATH=NEWTON'//choices//nl, 1), two, &
         & second, error)
      if (refused(error)) return
      call equal_text('path', first%path, 'condensed')
      call equal_text('path', second%path, 'newton')
      call same('displacement', one%u, two%u, maxval(abs(one%u)))
      call same('reaction', one%rf, two%rf, maxval(abs(one%rf)))
      associate (a => one%contact(1), b => two%contact(1))
         call same('force', a%force, b%force, maxval(abs(a%force)))
         call close_to('pressure', b%pressure/maxval(a%pressure), &
            & a%pressure/maxval(a%pressure), digits)
         call close_to('gap', b%gap/maxval(abs(one%u)), a%gap/maxval(abs(one%u)), digits)
      end associate
      call is_true('one factorisation is enough', first%step(1)%counter%factorisations == 1)
      call is_true('changes of contact cost factorisations', &
         & second%step(1)%counter%factorisations > 1)
   end subroutine paths_agree

   !> Two pairs on one pair of surfaces: the condensed path shares the forces, this one cannot.
   subroutine dependent_rows_are_named()
      type(frame_type) :: frame
      type(summary_type) :: summary
      type(error_type), allocatable :: error
      character(len=*), parameter :: again = '*SURFACE, NAME=ALSO'//nl &
         & //'UPFE, S1'//nl//'*CONTACT PAIR, INTERACTION=TOUCH'//nl//'ALSO, LOWF'//nl

      call test('rows that depend on each other are named')
      call run_text(scene_text('roller', ', DIRECT', again//'*LOPIN, PATH=NEWTON'//nl, 1), &
         & frame, summary, error)
      call is_true('an error', allocated(error))
      if (.not. allocated(error)) return
      call equal_text('code', error%item(1)%id, 'E0310')
      call is_true('why', index(error%item(1)%message, 'depend on each other') > 0)
   end subroutine dependent_rows_are_named

   logical function refused(error)
      type(error_type), allocatable, intent(in) :: error
      refused = allocated(error)
      if (refused) print '(a)', error%text()
      call is_true('no error', .not. refused)
   end function refused

   !> Equal beside the largest entry, which must not be zero.
   subroutine same(name, one, two, scale)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: one(:, :), two(:, :), scale

      call is_true('something to compare: '//name, scale > 0.0_wp)
      call close_to(name, two/scale, one/scale, digits)
   end subroutine same
end program test_paths
