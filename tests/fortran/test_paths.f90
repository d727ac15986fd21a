!> The condensed path against the whole system factorised at every change of contact.
program test_paths
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_state, only : summary_type
   use check, only : test, close_to, is_true, equal_text, finish
   use contact_scenes, only : scene_names, scene_text, run_text, get_last
   implicit none

   character(len=1), parameter :: nl = achar(10)
   character(len=20), parameter :: method(4) = [character(len=20) :: 'DIRECT', 'PENALTY', &
      & 'PERTURBED LAGRANGE', &
      & 'AUGMENTED LAGRANGE']
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
   call finish()

contains

   subroutine paths_agree(scene, behaviour, choices)
      character(len=*), intent(in) :: scene, behaviour
      character(len=*), intent(in) :: choices   !! more parameters of *LOPIN
      type(recorder_holder_type), allocatable :: one(:), two(:)
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
      call same('U', one, two)
      call same('RF', one, two)
      call same(':CPRESS', one, two)
      call same(':R_n', one, two)
      call same_gap(one, two)
      call is_true('one factorisation is enough', first%step(1)%counter%factorisations == 1)
      call is_true('changes of contact cost factorisations', &
         & second%step(1)%counter%factorisations > 1)
   end subroutine paths_agree

   logical function refused(error)
      type(error_type), allocatable, intent(in) :: error
      refused = allocated(error)
      if (refused) print '(a)', error%text()
      call is_true('no error', .not. refused)
   end function refused

   !> To 1e-10 of the largest entry, which must not be zero.
   subroutine same(name, one, two)
      character(len=*), intent(in) :: name
      type(recorder_holder_type), intent(in) :: one(:), two(:)
      real(wp) :: scale, other
      real(wp), allocatable :: a(:, :), b(:, :)

      call get_last(one, name, a, scale)
      call get_last(two, name, b, other)
      call is_true('something to compare: '//name, scale > 0.0_wp)
      call close_to(name, b/scale, a/scale, 1.0e-10_wp)
   end subroutine same

   !> To 1e-10 of the largest displacement.
   subroutine same_gap(one, two)
      type(recorder_holder_type), intent(in) :: one(:), two(:)
      real(wp) :: scale, other
      real(wp), allocatable :: a(:, :), b(:, :)

      call get_last(one, 'U', a, scale)
      call get_last(one, ':COPEN', a, other)
      call get_last(two, ':COPEN', b, other)
      call close_to('gap', b/scale, a/scale, 1.0e-10_wp)
   end subroutine same_gap
end program test_paths
