!> Whether a part of the master is narrower than the slave's facets opposite.
!>
!> A punch narrower than a facet presses the whole facet: force and pressure are those of the coarse
!> mesh, up to two thirds too large. A part that covers no facet wholly, and no node as a punch one
!> facet wide does that stands on it, is narrow. Up to about one and a half facets the force is
!> still that of a coarse mesh, a few per cent too large on first-order faces (and more on constant
!> strain): such a part covers no node's functions wholly.
module lopin_narrow_master
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_list_type
   use lopin_mortar_cover, only : cover_type
   implicit none
   private
   public :: narrowest_part

   !> The share of a node that a punch one facet wide covers.
   real(wp), parameter :: one_facet = 0.75_wp
   real(wp), parameter :: wholly = 1.0_wp - 1.0e-3_wp
   !> The share of a node that a wider part covers, and its width in facets.
   real(wp), parameter :: whole_node = 0.97_wp, slim = 1.6_wp
   !> Parts farther away than this, in facets, are not asked.
   real(wp), parameter :: near = 1.0_wp

contains

   !> Width of the narrowest part, in facets of the slave: below one where it is narrow; huge where
   !> none is narrow or slim. Parts are covered facets of one smooth piece that hang together.
   pure real(wp) function narrowest_part(slave, area, list, cover) result(width)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: area(:)          !! (slave facets) [area]
      type(overlap_list_type), intent(in) :: list
      type(cover_type), intent(in) :: cover    !! planned
      real(wp) :: share(slave%facets%n), away(slave%facets%n), ratio(slave%nnode)
      real(wp) :: part
      integer :: i
      logical :: met(slave%facets%n)

      ratio = covered_share(slave, area, list, cover)
      share = 0.0_wp
      away = huge(1.0_wp)
      do i = 1, list%n
         associate (o => list%item(i))
            share(o%slave) = share(o%slave) + o%area/area(o%slave)
            away(o%slave) = min(away(o%slave), abs(sum(o%gap))/max(tiny(1.0_wp), o%area) &
               & /slave%size(o%slave))
         end associate
      end do
      width = huge(1.0_wp)
      met = .not. share > 0.0_wp
      do i = 1, slave%facets%n
         if (met(i)) cycle
         call check_part(slave, share, away, ratio, i, met, part)
         width = min(width, part)
      end do
   end function narrowest_part

   !> Share of a node's function that is covered. A function of second order does not reach as far
   !> as a punch one facet wide: of such facets those of the corners alone count, which are linear.
   pure function covered_share(slave, area, list, cover) result(ratio)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: area(:)
      type(overlap_list_type), intent(in) :: list
      type(cover_type), intent(in) :: cover
      real(wp) :: ratio(slave%nnode), covered(slave%nnode), whole(slave%nnode)
      integer :: i, k, n, nc

      ratio = cover%ratio
      covered = 0.0_wp
      whole = 0.0_wp
      do i = 1, slave%facets%n
         nc = slave%basis%ncorner(slave%facets%cell(i))
         if (slave%facets%nnode(i) == nc) cycle
         associate (own => slave%local(:slave%facets%nnode(i), i))
            ratio(own) = 0.0_wp
            whole(own(:nc)) = whole(own(:nc)) + area(i)/nc
         end associate
      end do
      do i = 1, list%n
         associate (o => list%item(i))
            n = slave%facets%nnode(o%slave)
            nc = slave%basis%ncorner(slave%facets%cell(o%slave))
            if (n == nc) cycle
            associate (own => slave%local(:n, o%slave))
               covered(own(:nc)) = covered(own(:nc)) + o%d(:nc)
               do k = 1, n - nc
                  covered(own(k)) = covered(own(k)) + 0.5_wp*o%d(nc + k)
                  covered(own(1 + mod(k, nc))) = covered(own(1 + mod(k, nc))) + 0.5_wp*o%d(nc + k)
               end do
            end associate
         end associate
      end do
      where (whole > 0.0_wp) ratio = covered/max(whole, tiny(1.0_wp))
   end function covered_share

   !> The part that holds a facet; marks its facets as met.
   pure subroutine check_part(slave, share, away, ratio, first, met, width)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: share(:), away(:)
      real(wp), intent(in) :: ratio(:)         !! (slave%nnode) covered
      integer, intent(in) :: first
      logical, intent(inout) :: met(:)
      real(wp), intent(out) :: width           !! in facets; huge: wide, or far
      integer :: waiting(slave%facets%n), n, i, k, j
      logical :: close, narrow, is_slim
      real(wp) :: facets

      narrow = .true.
      is_slim = .true.
      facets = 0.0_wp
      close = .false.
      n = 1
      waiting(1) = first
      met(first) = .true.
      do while (n > 0)
         i = waiting(n)
         n = n - 1
         close = close .or. away(i) < near
         narrow = narrow .and. share(i) < wholly
         facets = facets + share(i)
         is_slim = is_slim .and. slave%basis%ncorner(slave%facets%cell(i)) == slave%facets%nnode(i)
         do k = 1, slave%facets%nnode(i)
            associate (node => slave%local(k, i))
               narrow = narrow .and. ratio(node) < one_facet
               is_slim = is_slim .and. ratio(node) < whole_node
               do j = slave%ring_first(node), slave%ring_first(node + 1) - 1
                  if (met(slave%ring(j))) cycle
                  met(slave%ring(j)) = .true.
                  n = n + 1
                  waiting(n) = slave%ring(j)
               end do
            end associate
         end do
      end do
      width = huge(1.0_wp)
      if (.not. close) return
      ! In space as wide as long: ribs are long, and told by their nodes.
      if (slave%ndim == 3) facets = sqrt(facets)
      if (is_slim .and. facets < slim) width = max(1.0_wp, facets)
      if (narrow) width = min(0.999_wp, facets)
   end subroutine check_part
end module lopin_narrow_master
