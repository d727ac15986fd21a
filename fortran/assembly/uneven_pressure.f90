!> How uneven the pressure of node to segment is where facets do not match.
!>
!> Slave nodes hand their forces to the master nodes opposite. A uniform pressure then gives a
!> master node l the force F_l = sum_j shape_jl weight_j, not its share A_l: what F/A deviates from
!> its mean the stresses of both bodies must make up for, the less the stiffer the master is (the
!> patch test, Taylor and Papadopoulos 1991). Where slave facets are the longer ones, most master
!> nodes meet none: by Poisson's sum of a hat function at the places of the slave nodes, the
!> deviation is sqrt(2) sinc^2(h_m/h_s). Both are set beside measured errors in the atlas, map 9.
module lopin_uneven_pressure
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_error, only : error_type, log_type, severity
   use lopin_facets, only : facets_type, new_facets
   use lopin_model, only : model_type, surface_of
   use lopin_slave_points, only : slave_type, new_slave
   use lopin_surface_material, only : extreme_moduli
   use lopin_text, only : to_text
   implicit none
   private
   public :: warn_of_uneven_pressure

   real(wp), parameter :: pi = acos(-1.0_wp)
   !> Unevenness that is said; slave facets longer than this beside the master's are too long.
   real(wp), parameter :: noticeable = 0.04_wp, longer = 1.05_wp
   !> Fitted to map 9: error over deviation on soft masters, and what E_m/E_s takes from it.
   real(wp), parameter :: by_sampling = 2.0_wp, by_length = 1.5_wp, relief = 1.4_wp

contains

   !> Warn of a pair whose contact is at the nodes, its master a mesh of linear facets.
   subroutine warn_of_uneven_pressure(model, cells, pair, facet, master, shape, weight, size_, log)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      integer, intent(in) :: facet(:)          !! (n) of the master, by slave point; 0: none
      integer, intent(in) :: master(:, :)      !! (:, n) nodes opposite
      real(wp), intent(in) :: shape(:, :)      !! (the same) their shares
      real(wp), intent(in) :: weight(:)        !! (n) [length^2]
      real(wp), intent(in) :: size_(:)         !! (n) of the slave's facets [length]
      type(log_type), intent(inout) :: log
      type(facets_type) :: facets
      type(slave_type) :: other
      type(error_type), allocatable :: error
      real(wp) :: uneven, ratio, softest, stiffest, unused

      associate (p => model%pair(pair), s => model%surface(model%pair(pair)%slave), &
         & m => model%surface(model%pair(pair)%master))
         if (s%kind /= surface_of%faces .or. m%kind /= surface_of%faces) return
         call new_facets(facets, model%mesh, cells, m%element, m%face)
         if (maxval(facets%nnode) > 4 .or. (model%mesh%ndim == 2 .and. maxval(facets%nnode) > 2)) &
            & return
         call new_slave(other, model, cells, m, error)
         if (allocated(error)) return
         call extreme_moduli(model, s%element, unused, stiffest)
         call extreme_moduli(model, m%element, softest, unused)
         if (.not. stiffest > 0.0_wp .or. .not. softest < huge(1.0_wp)) return
         ratio = length_ratio(facet, master, shape, weight, size_, other, model%mesh%nnode)
         if (ratio > longer) then
            uneven = by_length*sqrt(2.0_wp)*(sin(pi/ratio)/(pi/ratio))**2
         else
            uneven = by_sampling*sampled(facets, facet, master, shape, weight, other, &
               & model%mesh%nnode)
         end if
         uneven = uneven/(1.0_wp + relief*softest/stiffest)
         if (uneven > noticeable) call log%say(severity%warning, 'W0333', 'pair ('//s%name// &
            & ', '//m%name//'): facets that do not match make the pressure uneven by about '// &
            & to_text(100.0_wp*min(uneven, 1.0_wp), 2)//' %', p%at, &
            & help='TYPE=SURFACE TO SURFACE; or the softer side with the shorter facets as slave')
      end associate
   end subroutine warn_of_uneven_pressure

   !> Mean length of slave facets over that of the master facets opposite.
   pure real(wp) function length_ratio(facet, master, shape, weight, size_, other, nnode)
      integer, intent(in) :: facet(:), master(:, :), nnode
      real(wp), intent(in) :: shape(:, :), weight(:), size_(:)
      type(slave_type), intent(in) :: other
      real(wp) :: length(nnode), own, opposite
      integer :: i, k

      length = 0.0_wp
      length(other%node) = other%size
      own = 0.0_wp
      opposite = 0.0_wp
      do i = 1, size(facet)
         if (facet(i) == 0) cycle
         own = own + weight(i)*size_(i)
         do k = 1, count(master(:, i) > 0)
            opposite = opposite + weight(i)*shape(k, i)*length(master(k, i))
         end do
      end do
      length_ratio = 0.0_wp
      if (opposite > 0.0_wp) length_ratio = own/opposite
   end function length_ratio

   !> Median deviation of F/A from its mean, over master nodes whose facets all meet slave nodes.
   pure real(wp) function sampled(facets, facet, master, shape, weight, other, nnode)
      type(facets_type), intent(in) :: facets
      integer, intent(in) :: facet(:), master(:, :), nnode
      real(wp), intent(in) :: shape(:, :), weight(:)
      type(slave_type), intent(in) :: other
      real(wp) :: force(nnode), area(nnode)
      real(wp), allocatable :: share(:)
      logical :: meets(0:facets%n), counted(nnode)
      integer :: i, k

      force = 0.0_wp
      meets = .false.
      do i = 1, size(facet)
         meets(facet(i)) = .true.
         if (facet(i) == 0) cycle
         do k = 1, count(master(:, i) > 0)
            force(master(k, i)) = force(master(k, i)) + weight(i)*shape(k, i)
         end do
      end do
      area = 0.0_wp
      area(other%node) = other%weight
      counted = area > 0.0_wp
      do i = 1, facets%n
         if (.not. meets(i)) counted(facets%node(:facets%nnode(i), i)) = .false.
      end do
      sampled = 0.0_wp
      share = pack(force, counted)/pack(area, counted)
      if (size(share) < 3) return
      sampled = median(abs(share*sum(pack(area, counted))/sum(pack(force, counted)) - 1.0_wp))
   end function sampled

   !> The middle one, by counting: lists are short.
   pure real(wp) function median(value)
      real(wp), intent(in) :: value(:)
      real(wp) :: low, high
      integer :: pass

      low = 0.0_wp
      high = maxval(value)
      do pass = 1, 30
         median = 0.5_wp*(low + high)
         if (2*count(value <= median) >= size(value)) then
            high = median
         else
            low = median
         end if
      end do
   end function median
end module lopin_uneven_pressure
