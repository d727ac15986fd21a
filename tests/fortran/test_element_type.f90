program test_element_type
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_words, element_kind, element_formulation, &
      & new_element_type
   use distinct_elements, only : stands_for_another
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none
   type(element_type) :: element
   logical :: found
   integer :: k

   do k = 1, size(element_words)
      call new_element_type(element, trim(element_words(k)), '', found)
      call test('every word gives an element: '//element_words(k))
      call is_true('found', found)
      if (element%kind /= element_kind%rigid) call tables_are_consistent()
   end do
   call words_mean_what_abaqus_says()
   call variants_say_how_they_are_read()
   call some_words_stand_for_another()
   call finish()

contains

   subroutine tables_are_consistent()
      real(wp) :: values(element%ngauss), exact(element%nnode)
      integer :: d

      call test('extrapolation to the nodes is exact for linear fields: '//element%word)
      call is_true('points', size(element%weight) == element%ngauss .and. element%ngauss > 0)
      call close_to('partition', sum(element%n, dim=1), spread(1.0_wp, 1, element%ngauss), &
         & 1.0e-14_wp)
      call close_to('constant', sum(element%extrapolation, dim=2), &
         & spread(1.0_wp, 1, element%nnode), 1.0e-13_wp)
      if (element%ngauss == 1) return
      do d = 1, element%ndim
         values = element%xi(d, :)
         if (maxval(values) - minval(values) < 0.1_wp) cycle   ! all points in one plane
         exact = element%cell%xi(d, :element%nnode)
         call close_to('linear', matmul(element%extrapolation, values), exact, 1.0e-13_wp)
      end do
   end subroutine tables_are_consistent

   subroutine expect(word, wish, kind, formulation, ngauss)
      character(len=*), intent(in) :: word, wish
      integer, intent(in) :: kind, formulation, ngauss
      call test('a word means kind, formulation and number of points')
      call new_element_type(element, word, wish, found)
      call is_true(word//' '//wish, found .and. element%kind == kind &
         & .and. element%formulation == formulation .and. element%ngauss == ngauss)
   end subroutine expect

   subroutine words_mean_what_abaqus_says()
      call expect('CPE4', '', element_kind%plane_strain, element_formulation%bbar, 4)
      call expect('CPE4R', '', element_kind%plane_strain, element_formulation%bbar, 4)
      call expect('CPE4', 'FULL', element_kind%plane_strain, element_formulation%full, 4)
      call expect('CPS4R', '', element_kind%plane_stress, element_formulation%full, 4)
      call expect('CAX8R', '', element_kind%axisymmetric, element_formulation%reduced, 4)
      call expect('CAX8', '', element_kind%axisymmetric, element_formulation%full, 9)
      call expect('C3D8', '', element_kind%solid, element_formulation%bbar, 8)
      call expect('C3D8I', '', element_kind%solid, element_formulation%enhanced, 8)
      call expect('CAX4I', '', element_kind%axisymmetric, element_formulation%enhanced, 4)
      call expect('CPE4I', 'FULL', element_kind%plane_strain, element_formulation%full, 4)
      call expect('C3D20R', '', element_kind%solid, element_formulation%reduced, 8)
      call expect('C3D20', '', element_kind%solid, element_formulation%full, 27)
      call expect('C3D15', '', element_kind%solid, element_formulation%full, 9)
      call expect('C3D6', '', element_kind%solid, element_formulation%full, 6)
      call expect('C3D10M', '', element_kind%solid, element_formulation%full, 4)
      call expect('C3D4', '', element_kind%solid, element_formulation%full, 1)
      call expect('CPE3', '', element_kind%plane_strain, element_formulation%full, 1)
      call expect('R3D4', '', element_kind%rigid, element_formulation%full, 0)
      call new_element_type(element, 'RAX2', '', found)
      call is_true('RAX2 is axisymmetric, in the plane, without dofs', element%axisymmetric &
         & .and. element%ndim == 2 .and. element%ndof == 0 .and. element%cell%nface == 2)
      call new_element_type(element, 'B31', '', found)
      call is_true('beams are not found', .not. found)
   end subroutine words_mean_what_abaqus_says

   subroutine variants_say_how_they_are_read()
      call test('variants carry a note, plain words do not')
      call new_element_type(element, 'CAX4', '', found)
      call equal_text('CAX4', element%note, '')
      call new_element_type(element, 'C3D20R', '', found)
      call equal_text('C3D20R', element%note, '')
      call new_element_type(element, 'CPE4RH', '', found)
      call is_true(element%note, index(element%note, 'B-bar') > 0 .and. index(element%note, &
         & 'pressure') > 0)
      call new_element_type(element, 'C3D8I', '', found)
      call equal_text('C3D8I', element%note, '')
      call new_element_type(element, 'C3D10I', '', found)
      call is_true(element%note, index(element%note, 'incompatible') > 0)
   end subroutine variants_say_how_they_are_read

   !> Hybrids, modified ones, reduced integration of first order, and modes of tetrahedra.
   subroutine some_words_stand_for_another()
      character(len=*), parameter :: others(6) = [character(len=7) :: 'CPE4R', 'CPS4R', 'CAX4R', &
         & 'C3D6R', 'C3D8R', 'C3D10I']
      character(len=:), allocatable :: word
      integer :: k

      call test('which words stand for another')
      do k = 1, size(element_words)
         word = trim(element_words(k))
         call is_true(word, stands_for_another(word, '') .eqv. (any(others == word) &
            & .or. scan(word(len(word):), 'HM') > 0))
      end do
   end subroutine some_words_stand_for_another
end program test_element_type
